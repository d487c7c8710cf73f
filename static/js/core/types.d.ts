// Types of the page's state and of the API's answers; the schemas come from its OpenAPI
// description.

import type {
  HttpMethod,
  MediaType,
  PathsWithMethod,
  RequiredKeysOf,
  ResponseObjectMap,
  SuccessResponse,
} from "openapi-typescript-helpers";
import type { MaybeOptionalInit, Middleware } from "../../vendor/openapi-fetch/index.d.mts";
import type { components, paths } from "./api-schema.d.ts";

export type Schemas = components["schemas"];

/** What the server answers has all that a request may leave out. */
type Filled<T> = T extends object ? { [K in keyof T]-?: Filled<Exclude<T[K], undefined>> } : T;

/**
 * Send a request of a method to a path that the API has. As in openapi-fetch, but a failure is
 * thrown, and a tuple of the answer stays one.
 */
type Send<M extends HttpMethod> = <
  P extends PathsWithMethod<paths, M>,
  Init extends MaybeOptionalInit<paths[P], M>,
>(
  path: P,
  ...init: RequiredKeysOf<Init> extends never ? [Init?] : [Init]
) => Promise<{
  data: Filled<SuccessResponse<ResponseObjectMap<paths[P][M & keyof paths[P]]>, MediaType>>;
  response: Response;
}>;

/** The HTTP API, as its OpenAPI description has it. */
export interface Server {
  GET: Send<"get">;
  POST: Send<"post">;
  PUT: Send<"put">;
  PATCH: Send<"patch">;
  DELETE: Send<"delete">;
  use: (middleware: Middleware) => void;
}

export type Clip = Schemas["ClipView"];
export type ClipAccepted = Schemas["ClipAccepted"];
export type Job = Schemas["JobView"];
export type Take = Schemas["TakeView"];
export type Topic = Schemas["TopicSeen"];
export type Timeline = Schemas["TimelineView"];
export type Poses = Schemas["PosesView"];
export type Sample = Schemas["SampleView"];
export type SampleLanguage = Schemas["SampleLanguageView"];
export type Session = Schemas["SessionView"];
export type Quota = Schemas["QuotaView"];
export type AuditEntry = Schemas["AuditView"];
export type Language = Filled<Schemas["LanguageView"]>;
export type LanguageSummary = Schemas["LanguageSummary"];
export type Gesture = Filled<Schemas["GestureView"]>;
export type Revision = Schemas["RevisionView"];
export type RevisionDiff = Filled<Schemas["RevisionComparison"]>;
export type GestureDiff = Filled<Schemas["GestureComparison"]>;
export type ExportContents = Schemas["ExportView"];
export type ExportedFile = Schemas["ExportedFile"];
export type Grammar = Filled<Schemas["GrammarEntry"]>;
export type Phrase = Filled<Schemas["PhraseEntry"]>;
export type GesturesPart = Filled<Schemas["GesturesEntry"]>;
export type SlotPart = Filled<Schemas["SlotEntry"]>;
export type GroupPart = Filled<Schemas["GroupEntry"]>;
export type SlotType = Filled<Schemas["SlotTypeEntry"]>;
export type SlotValue = Filled<Schemas["SlotValueEntry"]>;
export type PhrasesAnswer = Schemas["PhrasesView"];
export type PhraseEvent = Schemas["PhraseEventView"];
export type Preview = Schemas["PreviewView"];
export type Keypoint = Schemas["KeypointView"];
export type Descriptor = Schemas["DescriptorView"];
export type Source = Filled<Schemas["SourceView"]>;
export type DemonstrationFault = Schemas["DemonstrationFaultView"];
export type Workspace = Schemas["OpenedWorkspace"];
export type LanguageSettings = Schemas["SettingsView"];
export type PracticeRecord = Schemas["PracticeRecordView"];
export type PracticeTake = Schemas["PracticeTakeView"];
export type Invitation = Schemas["InvitationView"];
export type NewInvitation = Schemas["NewInvitationView"];
export type Invited = Schemas["InvitedView"];
export type InvitedGesture = Schemas["InvitedGestureView"];
export type InvitedTake = Schemas["InvitedTakeView"];
export type ReceivedTake = Schemas["ReceivedTakeView"];
export type ReceivedTakeOutlook = Schemas["ReceivedTakeOutlook"];
export type Demonstration = Filled<Schemas["DemonstrationView"]>;
export type WorkspaceView = Schemas["ViewRequest"];
export type WrittenSession = Schemas["WrittenSessionView"];
export type TakeTable = Schemas["TakeTableView"];
export type TakeRow = Schemas["TakeRowView"];
export type TestSet = Schemas["TestSetView"];
export type LabelledTake = Schemas["LabelledTakeView"];
export type TriggerDraft = Schemas["TriggerDraft"];
export type Tuning = Schemas["TuningEntry"];
export type Problem = Partial<Schemas["Problem"]>;
export type PhrasePart = GesturesPart | SlotPart | GroupPart;

/** Some of the clips, newest first. */
export interface ClipPage {
  clips: Clip[];
  /** Whether another page follows. */
  more: boolean;
  /** The number of all clips, on the first page of all. */
  total: number;
}

/** A rate with its 95 % interval, each in [0, 1]. */
export interface Rate {
  rate: number;
  low: number;
  high: number;
}

/** A rate of `n` takes. */
export interface CountedRate extends Rate {
  n: number;
}

/** What is to be expected of an edited gesture in its language. */
export type Outlook = Schemas["OutlookView"];

/** A position, x right and y down; null where it was not seen. */
export type Place = [number, number] | null;

/** How dynamic time warping pairs the steps of a take with those of a gesture. */
export type Alignment = Schemas["Alignment"];

/** Why a take is not read as the gesture meant; `start` is null if it lasts throughout. */
export type Cause = Schemas["Cause"];

/** The effect of an intervention on the known takes, and on the language's demonstrations. */
export type SideEffect = Schemas["LanguageEffect"];

/** What an intervention changes, also in words. */
export type Intervention = { words: string } & (
  | { kind: "trim"; start: number; end: number }
  | { kind: "weight_factor"; voter: string; factor: number }
  | { kind: "keypoint_repair"; on: boolean }
  | { kind: "switch"; label: string; switch: SwitchName; position: Gesture["direction"] }
  | { kind: "further_demonstration"; label: string }
  | {
      kind: "demonstration_cut";
      label: string;
      clip_id: string;
      clip_start: number;
      clip_end: number;
    }
);

/** The properties of a movement that can count or not. */
export type SwitchName = "direction" | "tempo" | "mirror" | "hand_shape";

/** A change under which the take is recognised as expected. */
export type Counterfactual = Omit<Schemas["Counterfactual"], "change"> & { change: Intervention };

/** The explanation of a recognition. */
export type Explanation = Omit<Schemas["ExplanationView"], "counterfactuals"> & {
  counterfactuals: Counterfactual[];
};

/** One stroke of a hand, in words and seconds. */
export type Piece = Schemas["Piece"];
export type Words = Schemas["Words"];

/** The two gestures between which a take lies, nearest first; null: it lies between no two. */
export type Pair = string[] | null;

/** The answer to a recognition. */
export type Recognition = Schemas["RecognitionView"];

/** The answer to a practised take. */
export type PracticeAnswer = Schemas["PracticeAnswerView"];

export type PairDifference = Schemas["ContrastView"];

/** Which takes of clips are told apart best, and why the others are left out. */
export type Choice = Schemas["ChoiceView"];

/** Another movement for a gesture, and what it would do to the language. */
export type Replacement = Schemas["ReplacementView"];

/** A finding of the health report; `error` marks an error, the others are notes. */
export interface Finding {
  kind: string;
  gestures: string[];
  message: string;
  error: boolean;
  /** Data URIs, one of each gesture, or none. */
  drawings: string[];
}

/** What takes are read as; all null where nothing can be foretold. */
export interface Outcomes {
  right: CountedRate | null;
  asked: CountedRate | null;
  refused: CountedRate | null;
  wrong: CountedRate | null;
}

/** What other people's takes of a language will be read as. */
export interface Forecast extends Outcomes {
  people: number;
  /** What can be promised, and whom to ask. */
  words: string;
  /** Whether another person should show the language. */
  asks_more: boolean;
  /** The share read right, by the number of other people who have shown the language. */
  curve: (Rate & { people: number; n: number })[];
  /** The demonstrations that are not read right by those of the other people. */
  failed: {
    gesture: string;
    demonstration: number;
    diver: string;
    outcome: keyof Outcomes;
    read_as: string[];
  }[];
}

export interface GestureHealth extends Outcomes {
  label: string;
  seconds: number | null;
  landmarks: { landmark: string; visible: number }[];
  /** What tells it apart beside its figure; null without a movement. */
  counts: { direction: boolean; tempo: boolean; sides: boolean; hand_shape: boolean } | null;
  nearest: { label: string; distance: number } | null;
}

export interface HealthReport {
  ok: boolean;
  verdict: Verdict;
  forecast: Forecast;
  warnings: Finding[];
  gestures: GestureHealth[];
  map: { label: string; x: number; y: number }[];
  /** Rates of the trigger; null unless it is a pose of the arms. */
  trigger: TriggerRates | null;
  /** The limit and its costs; null in a language without movements. */
  limit: LimitCosts | null;
}

/** What the check and the test set say of a language together. */
export interface Verdict {
  ready: boolean;
  words: string;
  errors: number;
  failing: { label: string; right: number; asked: number }[];
  untested: string[];
}

/** The limit of a language, with its two costs; null where one person has shown the gestures. */
export interface LimitCosts {
  people: number;
  most_refused: number;
  limit: number;
  /** Whether the limit follows from `most_refused`; otherwise it is a cautious constant. */
  measured: boolean;
  refused: CountedRate | null;
  accepted: CountedRate | null;
}

export interface TriggerRates {
  words: string;
  missed: CountedRate;
  false_per_hour: number;
  set_off_by: string[];
}

/** The progress of a health check; `total` is 0 while it is unknown. */
export interface CheckProgress {
  id: string;
  revision: number;
  stage: string;
  done: number;
  total: number;
}

/** The progress of a clip's MCAP file, or of a table of takes. */
export interface ExportProgress {
  /** The export, as the page named it. */
  id: string;
  stage: string;
  done: number;
  total: number;
  /** Seconds left, where they are known. */
  eta_s: number | null;
}

/** The health report on display, or the progress towards it. */
export interface HealthState {
  key: string;
  id: string;
  revision: number;
  status: "checking" | "done" | "cancelled" | "failed";
  report: HealthReport | null;
  shown: number | null;
  error?: string;
  away?: boolean;
}

/** The clips whose poses are found one after the other, and how many frames are done. */
export interface Batch {
  members: string[];
  /** The first reported number of frames, and its time in milliseconds. */
  began: { frames: number; at: number } | null;
  frames: number;
  left: number;
  at: number;
}

/** A file on its way to the server. */
export interface Upload {
  key: string;
  file: File;
  first: boolean;
  uploaded: ((clip: string) => void) | null;
  fields: Record<string, string>;
  status: "waiting" | "uploading" | "failed";
  loaded: number;
  total: number;
  away: boolean;
  began: { loaded: number; at: number } | null;
  error: string | null;
  refused?: Error & { code?: string };
  cancel: (() => void) | null;
}

/** The position of the workspace's clock. */
export interface Position {
  playing: boolean;
  frame: number;
  frames: number;
  time: number;
  speed: number;
  loop: boolean;
  picture: number | null;
}

/** A counterfactual tried on a copy of the language and not kept yet. */
export interface Trial {
  change: Intervention;
  base: Partial<State>;
  result: string;
}

/** A clip of the test with known labels that is not recognised yet. */
export interface PendingClip {
  clip: string;
  language: string | null;
  expected: string | null;
}

/** How much of the library is loaded. */
export interface Library {
  /** The oldest clip of the part loaded without gaps; null if all are loaded. */
  last: Clip | null;
  /** The number of older clips. */
  older: number;
}

export interface State {
  view: string | null;
  source: string | null;
  /** The loaded clips: the newest, and those requested or referred to by id. */
  clips: Clip[];
  /** The clip that the page showed last by its own choice: the newest, one just uploaded, or a deleted one's neighbour. */
  offered: string | null;
  library: Library;
  uploads: Upload[];
  jobs: Map<string, Job>;
  takes: Take[] | null;
  samples: Sample[];
  timeline: Timeline | null;
  position: Position | null;
  frame: number | null;
  languages: LanguageSummary[];
  /** The language on display, with its gestures. */
  gestures: Language | null;
  result: Recognition | null;
  why: Explanation | null;
  trial: Trial | null;
  question: { clip: string; expected: string } | null;
  /** What the token may do; null until the server has answered. */
  role: Session["role"] | null;
  /** What the token's name stores and may store; null without a limit. */
  quota: Quota | null;
  connected: boolean | null;
  /** How often the server came back; failed requests are then repeated. */
  returns: number;
  loaded: boolean;
  health: HealthState | null;
  checking: CheckProgress | null;
  /** The findings of which the health view shows all, not only the first. */
  unfolded: Finding[] | null;
  /** The invitations of a language, the newest first. */
  invitations: { language: string; kept: Invitation[] } | null;
  exporting: ExportProgress | null;
  /** The progress of a table of takes; its id is the table's. */
  tabling: ExportProgress | null;
  testSet: TestSet | null;
  /** The progress of the test set's run; null while none runs. */
  testing: { id: string; done: number; total: number } | null;
  /** The language whose test set changed on the server. */
  labelled: { id: string } | null;
  pending: PendingClip[];
  /** Ranges of clips that were labelled by hand and wait to be saved together. */
  ranges: { label: string; clip_id: string; start: number; end: number }[];
  clip: string | null;
  take: number | null;
  start: number | null;
  end: number | null;
  language: string | null;
  gesture: string | null;
  recognition: string | null;
  joint: string | null;
  panel: string | null;
  older: number | null;
  newer: number | null;
  pair: string | null;
  cell: string | null;
  phrase: string | null;
  shown: string | null;
  paused: string | null;
}

/** An action that can be undone: plain data of a registered kind. */
export interface Action {
  title: string;
  kind: string;
  [name: string]: any;
}

/** How the actions of a kind are undone and redone. */
export interface UndoHandlers {
  undo: (action: any) => Promise<unknown>;
  redo: (action: any) => Promise<unknown>;
  record: (action: any) => Action;
}

/** A field of a dialog. */
export interface Field {
  name: string;
  label: string;
  value?: string;
  required?: boolean;
  hint?: string;
  multiline?: boolean;
  /** The greatest number of characters. */
  most?: number;
}

/** A gesture to make from a clip's take; `takes` is null while the clip's poses are being found. */
export interface GestureRow {
  key: string;
  clip: Clip;
  takes: Take[] | null;
  take: Take | null;
  number: number;
  label: string;
  chosen: boolean;
  /** The gesture of the language of which it would be a further demonstration, or "". */
  further: string;
  /** Whether the language reads it as that gesture already. */
  right: boolean;
  /** Why a choice of the best has left it out, or "". */
  why: string;
}

/** A view of the page, loaded when it is first shown. */
export interface View {
  name: string;
  title: string;
  load?: () => Promise<{ open: (section: HTMLElement) => void }>;
  passing?: boolean;
}

/** What a key does. */
export interface Binding {
  keys: string[];
  text: string;
  group: string;
  run: (event: KeyboardEvent) => unknown;
  when: () => boolean;
}

export interface KeyListActions {
  loadAll: () => Promise<unknown>;
  startTour: () => void;
  showExample: () => void;
}

/** A command of a menu, or a file to download. */
export type MenuItem =
  | { text: string; run: () => unknown; href?: undefined; writes?: boolean }
  | { text: string; href: string; run?: undefined; writes?: undefined };

/** The range in seconds on which buttons act, the part of it to show, and its take, if any. */
export interface SelectedRange {
  start: number;
  end: number;
  shown: [number, number];
  take: Take | null;
}

/** The progress of an upload: its address, the bytes received, and the clip's id once complete. */
export interface Stand {
  place: string;
  offset: number;
  clip: string | null;
}
