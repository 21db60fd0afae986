"""The web server of the bench: this machine alone, by a token in the address, nothing from elsewhere.

Other machines reach it where the user asks for that, with a password besides.
"""

from __future__ import annotations

import hmac
import json
import secrets
import socket
from asyncio import Future
from pathlib import Path
from typing import Any

from tornado.httpserver import HTTPServer
from tornado.web import Application, HTTPError, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler
from typing_extensions import override

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import from_json
from cranktopo.report.viewer.scene3d import SCRIPT
from cranktopo.tasks.bench.access import COOKIE, Password
from cranktopo.tasks.bench.session import Bench

HOST = "127.0.0.1"
_PAGE = Path(__file__).parent / "page"
_TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
_MOST_MESSAGE, MOST_UPLOAD = 1 << 20, 64 << 20
_REPORT_POLICY = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:"
)
"""Of the reports of runs, which are one file each: they may do nothing here."""


class Server:
    """A bench that listens.

    Attributes:
        address: of the page, its token included.
    """

    def __init__(
        self, bench: Bench, port: int = 0, host: str = HOST, password: Password | None = None
    ) -> None:
        self.bench, self.token = bench, secrets.token_urlsafe(24)
        self.host, self.password = host, password
        listening = _listening(host, port)
        self.port = int(listening.getsockname()[1])
        self.address = f"http://{host}:{self.port}/{self.token}/"
        routes: list[Any] = [
            (r"/([^/]+)/", _File, {"name": "bench.html"}),
            (r"/([^/]+)/([a-z]+\.(?:css|js))", _File),
            (r"/([^/]+)/talk", _Talk),
            (r"/([^/]+)/upload", _Upload),
            (r"/([^/]+)/login", _Login),
            (r"/([^/]+)/made/([^/]+)", _Made),
            (r"/([^/]+)/job/([0-9]+)", _Report),
            (r".*", _Nothing),
        ]
        application = Application(
            routes,
            bench_server=self,
            websocket_max_message_size=_MOST_MESSAGE,
            websocket_ping_interval=20,
            log_function=lambda handler: None,
        )
        self._http = HTTPServer(application, max_body_size=MOST_UPLOAD, max_buffer_size=MOST_UPLOAD)
        self._http.add_socket(listening)

    def close(self) -> None:
        """Stop listening, end the processes."""
        self._http.stop()
        self.bench.close()

    @property
    def origins(self) -> tuple[str, ...]:
        """Origins of the page itself."""
        names = (HOST, "localhost") if self.host == HOST else (self.host,)
        return tuple(f"http://{name}:{self.port}" for name in names)


def _listening(host: str, port: int) -> socket.socket:
    """Return a socket that listens on one address; raises CranktopoError where that cannot be used."""
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        found.bind((host, port))
        found.listen()
    except OSError as error:
        found.close()
        where = f"--port {port}" if host == HOST else f"--host {host}"
        hint = "Leave --port out to take a free one." if host == HOST else "Take an address of this machine."
        raise CranktopoError(f"{where}: cannot be used: {error.strerror}.", hint=hint) from None
    found.setblocking(False)
    return found


class _Guarded(RequestHandler):
    """Rules that every request keeps: host, token, password, and for what changes something the origin."""

    open_to_all = False

    @property
    def server(self) -> Server:
        found: Server = self.application.settings["bench_server"]
        return found

    @property
    def hosts(self) -> set[str]:
        return {origin.removeprefix("http://") for origin in self.server.origins}

    @override
    def prepare(self) -> None:
        if self.request.headers.get_list("Host") not in [[host] for host in self.hosts]:
            raise HTTPError(403)
        token = self.path_args[0] if self.path_args else ""
        if not hmac.compare_digest(str(token).encode(), self.server.token.encode()):
            raise HTTPError(403)
        origin = self.request.headers.get("Origin")
        wrong = origin is not None and origin not in self.server.origins
        changing = self.request.method not in ("GET", "HEAD")
        if (
            wrong
            or (changing and origin is None)
            or self.request.headers.get("Sec-Fetch-Site") == "cross-site"
        ):
            raise HTTPError(403)
        if not self.admitted and not self.open_to_all:
            raise HTTPError(401)

    @property
    def admitted(self) -> bool:
        """True for a browser that gave the password, where there is one."""
        password = self.server.password
        return password is None or password.admits(self.get_cookie(COOKIE))

    @override
    def set_default_headers(self) -> None:
        own = " ".join(origin.replace("http:", "ws:") for origin in self.server.origins)
        for name, value in {
            "Server": "cranktopo",
            "Content-Security-Policy": (
                "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
                f"connect-src 'self' {own}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
            ),
            "Cache-Control": "no-store",
            "Cross-Origin-Opener-Policy": "same-origin",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
        }.items():
            self.set_header(name, value)

    @override
    def write_error(self, status_code: int, **kwargs: Any) -> None:
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"{status_code}\n")


class _Nothing(_Guarded):
    @override
    def prepare(self) -> None:
        raise HTTPError(404)


class _File(_Guarded):
    """A file of the page, which holds nothing of the session; its first one asks for the password."""

    open_to_all = True

    @override
    def initialize(self, name: str = "") -> None:
        self.name = name

    def get(self, token: str, name: str = "") -> None:
        name = (self.name if self.admitted else "login.html") if self.name else name
        path = SCRIPT if name == SCRIPT.name else _PAGE / name
        if not path.is_file():
            raise HTTPError(404)
        self.set_header("Content-Type", f"{_TYPES[path.suffix]}; charset=utf-8")
        self.finish(path.read_bytes())


class _Made(_Guarded):
    """A file that the page had written, to be downloaded."""

    def get(self, token: str, name: str) -> None:
        try:
            path = self.server.bench.written_file(name)
        except CranktopoError:
            raise HTTPError(404) from None
        self.set_header("Content-Type", "application/octet-stream")
        self.set_header("Content-Disposition", f'attachment; filename="{path.name}"')
        self.finish(path.read_bytes())


class _Report(_Guarded):
    def get(self, token: str, job: str) -> None:
        try:
            path = self.server.bench.report_of(job)
        except CranktopoError:
            raise HTTPError(404) from None
        self.set_header("Content-Security-Policy", _REPORT_POLICY)
        self.set_header("Content-Type", "text/html; charset=utf-8")
        self.finish(path.read_bytes())


class _Login(_Guarded):
    """The password of a browser, which gets a cookie that scripts do not see and no other site sends."""

    open_to_all = True

    def post(self, token: str) -> None:
        password = self.server.password
        cookie = password and password.cookie_for(self.request.body[:1000].decode("utf-8", "replace"))
        if not cookie:
            raise HTTPError(401)
        self.set_cookie(COOKIE, cookie, path=f"/{token}/", httponly=True, samesite="Strict")
        self.finish()


class _Upload(_Guarded):
    async def post(self, token: str) -> None:
        try:
            found = await self.server.bench.uploaded(self.get_query_argument("name", ""), self.request.body)
        except CranktopoError as error:
            found = {"error": str(error)}
        self.set_header("Content-Type", "application/json")
        self.finish(json.dumps(found))


class _Talk(_Guarded, WebSocketHandler):
    """One page that is open: what it asks, and what it is told."""

    @override
    def check_origin(self, origin: str) -> bool:
        return origin in self.server.origins

    @override
    def prepare(self) -> None:
        super().prepare()
        if self.request.headers.get("Origin") not in self.server.origins:
            raise HTTPError(403)

    @override
    def open(self, *args: str, **kwargs: str) -> None:
        self.server.bench.enter(self.tell)

    @override
    def on_close(self) -> None:
        self.server.bench.leave(self.tell)

    def tell(self, message: dict[str, Any]) -> None:
        try:
            self.write_message(json.dumps(message, allow_nan=False)).add_done_callback(self._sent)
        except WebSocketClosedError:
            self.server.bench.leave(self.tell)

    def _sent(self, message: Future[None]) -> None:
        """Let go of a page that was closed while a message was on its way."""
        error = message.exception()
        if isinstance(error, WebSocketClosedError):
            self.server.bench.leave(self.tell)
        elif error:
            raise error

    @override
    async def on_message(self, message: str | bytes) -> None:
        try:
            decoded = from_json(message if isinstance(message, str) else message.decode())
            if not isinstance(decoded, dict):
                raise ValueError
        except ValueError:
            self.close(1003)
            return
        await self.server.bench.hear(decoded, self.tell)
