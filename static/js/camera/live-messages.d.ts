// The messages of the live view's WebSocket.

/** A point as shares of the picture's width and height; null where it is not seen. */
type Point = [number, number] | null;

/** The result of one frame. */
export interface Seen {
  kind: "seen";
  time: number;
  pose: Point[] | null;
  hands: Point[][];
  salute: number;
  held: boolean;
  state: "idle" | "recording" | "done";
  frames_per_second: number;
  seconds: number;
  skipped: number;
}

/** The result of one take. */
export interface Recognized {
  kind: "recognized";
  start: number;
  end: number;
  closed: boolean;
  language: string | null;
  label: string | null;
  /** The two gestures between which the take lies, nearest first. */
  pair: string[] | null;
  nearest: string | null;
  confidence: number | null;
  voters: number;
  agreeing: number;
  problem: string | null;
}

/** The language that recognises the takes; without one, `problem` says why. */
export interface Listening {
  kind: "listening";
  language: string | null;
  gestures: number;
  problem: string | null;
}

/** The message to the user when the source or the connection fails. */
export interface Trouble {
  title: string;
  text: string;
}

/** Called with each message; `seconds` is the time since the frame was captured. */
export interface Handlers {
  seen: (answer: Seen, seconds: number) => void;
  recognized: (result: Recognized) => void;
  listening: (answer: Listening) => void;
  ended: (reason: string) => void;
}
