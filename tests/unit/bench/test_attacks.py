"""What a page of another site, another user or a bad file may try: nothing of it gets in."""

from __future__ import annotations

import asyncio
import gc
import json
import socket
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("tornado")
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest, HTTPResponse
from tornado.websocket import websocket_connect

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import design_text
from cranktopo.tasks.bench.access import Password
from cranktopo.tasks.bench.project import Project, file_in
from cranktopo.tasks.bench.server import HOST, MOST_UPLOAD, Server
from cranktopo.tasks.bench.session import Bench

MIKRON = "mikron-iiic-plain"


class Running:
    """A server in a thread of its own, with a design on the bench and no processes that answer."""

    def __init__(self, folder: Path, host: str = HOST, password: Password | None = None) -> None:
        self.host, self.password = host, password
        self.folder, self.loop = folder, asyncio.new_event_loop()
        self.thread = threading.Thread(target=self.loop.run_forever, daemon=True)
        self.thread.start()
        self.server: Server = self.do(self._start)

    def do(self, work: Callable[[], Any]) -> Any:
        return asyncio.run_coroutine_threadsafe(work(), self.loop).result(600)

    async def _start(self) -> Server:
        bench = Bench(self.folder)
        bench.project = Project.opened(
            self.folder, design_text(MIKRON), "web.toml", "opened", "cranktopo bench"
        )
        return Server(bench, 0, self.host, self.password)

    def get(self, path: str, **how: Any) -> HTTPResponse:
        address = f"http://{self.host}:{self.server.port}{path}"

        async def fetch() -> HTTPResponse:
            return await AsyncHTTPClient().fetch(
                HTTPRequest(address, follow_redirects=False, request_timeout=600, **how)
            )

        found: HTTPResponse = self.do(fetch)
        return found

    def code(self, path: str, **how: Any) -> int:
        try:
            return int(self.get(path, **how).code)
        except HTTPClientError as error:
            return int(error.code)

    def talk(self, *messages: str | bytes, origin: str | None = "", token: str = "") -> list[dict[str, Any]]:
        """Send messages on the socket of a page; return what is told first, nothing where it closes."""
        own = f"http://{self.host}:{self.server.port}"
        headers = {} if origin is None else {"Origin": origin or own}
        address = f"ws://{self.host}:{self.server.port}/{token or self.server.token}/talk"

        async def exchange() -> list[dict[str, Any]]:
            line = await websocket_connect(HTTPRequest(address, headers=headers, connect_timeout=600))
            for message in messages:
                await line.write_message(message, binary=isinstance(message, bytes))
            told: dict[str, Any] | None = {"type": "jobs"}
            while told is not None and told["type"] == "jobs":
                line_told = await asyncio.wait_for(line.read_message(), 600.0)
                told = None if line_told is None else json.loads(line_told)
            line.close()
            while told is not None and await line.read_message() is not None:
                pass
            return [] if told is None else [told]

        answer: list[dict[str, Any]] = self.do(exchange)
        return answer

    def close(self) -> None:
        self.do(self.server._http.close_all_connections)
        self.loop.call_soon_threadsafe(self.server.close)
        self.loop.call_soon_threadsafe(self.loop.stop)
        self.thread.join(10)


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    folder = tmp_path_factory.mktemp("place") / "chosen"
    folder.mkdir()
    (folder.parent / "secret.toml").write_text("outside", encoding="utf-8")
    found = Running(folder)
    yield found
    found.close()


@pytest.fixture
def own(running: Running) -> str:
    return f"/{running.server.token}"


def test_the_page_is_there_and_may_load_nothing_from_elsewhere(running: Running, own: str) -> None:
    found = running.get(f"{own}/")
    policy = found.headers["Content-Security-Policy"]
    assert found.code == 200
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert found.headers["Referrer-Policy"] == "no-referrer"
    text = found.body.decode()
    assert "http" not in text.replace("http://www.w3.org", "")
    assert " style=" not in text
    for name in ("bench.js", "forms.js", "bench.css", "viewer.js"):
        assert running.code(f"{own}/{name}") == 200
    assert running.code(f"{own}/other.js") == 404


def test_it_listens_on_this_machine_alone(running: Running) -> None:
    for listening in running.server._http._sockets.values():
        assert listening.getsockname()[0] == "127.0.0.1"
        assert listening.family == socket.AF_INET


@pytest.mark.parametrize("path", ["/", "/wrong/", "/wrong/talk", "/wrong/bench.js", "//", "/%00/"])
def test_without_the_token_there_is_nothing(running: Running, path: str) -> None:
    assert running.code(path) in (400, 403, 404)


@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1:1", "evil.example:80", "127.0.0.1.evil.example", ""]
)
def test_a_name_that_is_rebound_to_this_machine_is_refused(running: Running, own: str, host: str) -> None:
    assert running.code(f"{own}/", headers={"Host": host}) in (400, 403)


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1", "https://127.0.0.1"])
def test_requests_of_another_site_are_refused(running: Running, own: str, origin: str) -> None:
    headers = {"Origin": origin}
    assert running.code(f"{own}/", headers=headers) == 403
    assert running.code(f"{own}/upload?name=a.toml", method="POST", body=b"x", headers=headers) == 403
    with pytest.raises(HTTPClientError, match="403"):
        running.talk(origin=origin)


def test_a_form_or_a_link_of_another_site_is_refused(running: Running, own: str) -> None:
    assert running.code(f"{own}/", headers={"Sec-Fetch-Site": "cross-site"}) == 403
    assert running.code(f"{own}/upload?name=a.toml", method="POST", body=b"x") == 403, "without an origin"
    with pytest.raises(HTTPClientError, match="403"):
        running.talk(origin=None)


def test_a_page_cannot_be_framed_and_its_files_are_not_shared(running: Running, own: str) -> None:
    headers = running.get(f"{own}/").headers
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert headers["Cross-Origin-Resource-Policy"] == "same-origin"
    assert "Access-Control-Allow-Origin" not in headers


@pytest.mark.parametrize(
    "path",
    [
        "/made/..%2fsecret.toml",
        "/made/%2e%2e/secret.toml",
        "/made//etc/passwd",
        "/job/..",
        "/job/999",
        "/server.py",
    ],
)
def test_no_path_leads_out(running: Running, own: str, path: str) -> None:
    assert running.code(f"{own}{path}") in (403, 404)


@pytest.mark.parametrize(
    "name", ["../x.toml", "/tmp/x.toml", "a/b.toml", ".hidden.toml", "x.sh", "x.toml\0", "..", "", "x\n.toml"]
)
def test_no_name_of_a_file_leads_out(running: Running, name: str) -> None:
    with pytest.raises(CranktopoError):
        file_in(running.folder, name, (".toml",))
    told = running.talk(json.dumps({"do": "save", "name": name}))
    assert [message["type"] for message in told] == ["error"]


def test_a_link_in_the_folder_is_not_followed(running: Running) -> None:
    link = running.folder / "link.toml"
    link.symlink_to(running.folder.parent / "secret.toml")
    told = running.talk(json.dumps({"do": "open", "name": "link.toml"}))
    assert [message["type"] for message in told] == ["error"]
    link.unlink()


@pytest.mark.parametrize("file", ["/etc/passwd", "../secret.toml"])
def test_a_design_cannot_name_files_outside_the_folder(running: Running, file: str) -> None:
    for action in ("edit", "drag"):
        changes = {"engine.gas.indicator_csv": file}
        told = running.talk(json.dumps({"do": action, "changes": changes}))
        assert told[0]["type"] == "error"
        assert "outside the folder" in told[0]["message"]


@pytest.mark.parametrize(
    "message",
    [
        "[]",
        "{}",
        "nonsense",
        '{"do": "_watch_jobs"}',
        '{"do": "__init__"}',
        '{"do": ["edit"]}',
        '{"do": 1e999}',
    ],
)
def test_messages_of_any_kind_are_answered_or_end_the_line(running: Running, message: str) -> None:
    check_untouched(running, message)


@pytest.mark.parametrize(
    "message",
    [
        '{"do": "edit"}',
        '{"do": "edit", "changes": 7}',
        '{"do": "edit", "changes": {"a b": null}}',
        '{"do": "edit", "changes": {"web.pocket[9]": {}}}',
        '{"do": "take", "id": "../state"}',
        "[" * 100_000,
    ],
    ids=range(6),
)
def test_actions_that_make_no_sense_change_nothing(running: Running, message: str) -> None:
    check_untouched(running, message)


def check_untouched(running: Running, message: str) -> None:
    told = running.talk(message)
    assert all(one["type"] == "error" for one in told)
    assert running.server.bench.project is not None
    assert running.server.bench.project.at == 0


@pytest.mark.parametrize(
    ("kind", "options"),
    [
        ("runs", {}),
        ("optimise", {"out": "/tmp/x"}),
        ("optimise", {"limit": ["a", {"b": 1}]}),
        ("fatigue", {"design": "/etc/passwd"}),
        ("lighter rod", {"lighter": "/tmp/x.toml"}),
        ("rod", {"drawing": "/tmp/x.pdf"}),
        ("shape; rm -rf .", {}),
    ],
)
def test_jobs_are_commands_of_the_page_alone(running: Running, kind: str, options: dict[str, Any]) -> None:
    told = running.talk(json.dumps({"do": "job", "kind": kind, "options": options}))
    assert told[-1]["type"] == "error"
    assert not list(running.folder.rglob("job.json"))


def test_uploads_are_bounded(running: Running, own: str) -> None:
    headers = {"Origin": f"http://127.0.0.1:{running.server.port}"}
    how: dict[str, Any] = {"method": "POST", "headers": headers}
    assert running.code(f"{own}/upload?name=a.toml", body=b"x" * (MOST_UPLOAD + 1), **how) in (400, 413, 599)
    assert not (running.folder / "a.toml").exists()


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("evil.sh", b"#!"),
        ("../a.toml", b"x"),
        ("a.toml", b""),
        ("a.toml", b"\xff\xfe\0"),
        ("a.toml", b"[" * 9000),
    ],
    ids=["suffix", "path", "empty", "binary", "deep"],
)
def test_a_bad_upload_is_one_line(running: Running, own: str, name: str, content: bytes) -> None:
    from urllib.parse import quote

    headers = {"Origin": f"http://127.0.0.1:{running.server.port}"}
    path = f"{own}/upload?name={quote(name, safe='')}"
    found = running.get(path, method="POST", body=content, headers=headers)
    assert set(json.loads(found.body)) == {"error"}
    (running.folder / "a.toml").unlink(missing_ok=True)


def test_a_message_of_megabytes_ends_the_line(running: Running) -> None:
    assert running.talk("x" * (2 << 20)) == []


def test_names_from_files_are_text_on_the_page() -> None:
    page = Path(__file__).parents[3] / "cranktopo" / "tasks" / "bench" / "page"
    text = "".join(script.read_text(encoding="utf-8") for script in page.glob("*.js"))
    assert "textContent" in text
    for markup in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(", "Function("):
        assert markup not in text


def test_a_page_that_closes_while_it_is_told_something_is_let_go_of(running: Running) -> None:
    """Nothing is left to the loop's handler, which would print a traceback."""
    left: list[dict[str, Any]] = []
    running.loop.set_exception_handler(lambda _, context: left.append(context))
    address = f"ws://127.0.0.1:{running.server.port}/{running.server.token}/talk"
    origin = {"Origin": f"http://127.0.0.1:{running.server.port}"}

    async def exchange() -> None:
        page = await websocket_connect(HTTPRequest(address, headers=origin))
        page.protocol.stream.close()
        for _ in range(200):
            running.server.bench._tell_all({"type": "note", "text": "x" * 100_000})
        await asyncio.sleep(0.2)
        page.close()  # the client's own end, which Tornado would else complain of when Python exits
        gc.collect()
        await asyncio.sleep(0.1)
        page.close()

    running.do(exchange)
    assert left == []
