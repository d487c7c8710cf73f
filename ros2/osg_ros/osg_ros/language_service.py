"""Language service: loads a node's language at configuration and reloads it on request."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from osg_interfaces.srv import ReloadLanguage
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup

from app.recognition.gestures.profile import PROFILES
from app.recognition.spotting import LONGEST_MEMORY
from app.robot import ActiveLanguage
from osg_ros.nodes.managed_node import ManagedNode
from osg_ros.parameters import Setting

LANGUAGE: Final = Setting("language", "", "Path of the language file on the robot.")
PROFILE: Final = Setting(
    "profile",
    "",
    "The recogniser's set of voters; empty: the language's own.",
    choices=("", *PROFILES),
)

WITHOUT_SALUTES: Final = Setting(
    "without_salutes",
    False,
    f"Recognise gestures without salutes; published up to {LONGEST_MEMORY:g} s after they end.",
)


class LanguageService:
    """Service `reload_language` of a node, which also loads its first language.

    The service runs in parallel to the node's other callbacks, so that no picture waits for it.

    Parameters
    ----------
    node
        Node whose parameters `LANGUAGE` and `PROFILE` define the first language.
    check
        Called with every language before it becomes active, maybe in another thread; raises a
        `ValueError` with the reason why the node cannot recognise it.
    change
        Called with every language after the first, maybe in another thread.

    Raises
    ------
    ValueError
        When the parameter is empty, or the file is not a language or one that `check` refuses.
    OSError
        When the file cannot be read.

    """

    def __init__(
        self,
        node: ManagedNode,
        check: Callable[[ActiveLanguage], object],
        change: Callable[[ActiveLanguage], None],
    ) -> None:
        self._node = node
        self._check = check
        self._change = change
        self._path: str = node.settings["language"]
        self._profile: str | None = node.settings["profile"] or None
        if not self._path:
            raise ValueError(
                "parameter language is empty; set it to a language file, exported from the studio "
                "or made by osg-studio define"
            )
        self.language = self._load(self._path)
        self._service = node.create_service(
            ReloadLanguage,
            "reload_language",
            self._reload,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )

    def facts(self) -> Mapping[str, str]:
        """Return the loaded language for diagnostics."""
        return {
            "language": self.language.name,
            "language id": self.language.sha256,
            "language revision": str(self.language.revision),
        }

    def close(self) -> None:
        """Remove the service."""
        self._node.destroy_service(self._service)

    def _load(self, path: str) -> ActiveLanguage:
        language = ActiveLanguage.load(path, self._profile)
        self._check(language)
        return language

    def _reload(
        self, request: ReloadLanguage.Request, response: ReloadLanguage.Response
    ) -> ReloadLanguage.Response:
        path = request.path or self._path
        try:
            language = self._load(path)
        except (ValueError, OSError) as error:
            response.message = f"{path} is refused, the language stays: {error}"
            self._node.report_problem(response.message)
        else:
            response.success = True
            response.message = (
                f"{language.name!r}, revision {language.revision}, with "
                f"{len(language.recognizer.language.labels)} gestures"
            )
            self._path, self.language = path, language
            self._change(language)
        response.language_id = self.language.sha256
        response.language_revision = self.language.revision
        return response
