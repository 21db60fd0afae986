"""A bench that other machines can reach: what they try without its password."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("tornado")
from tornado.httpclient import HTTPClientError

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.tasks.bench.access import COOKIE, Password, check_host
from tests.unit.bench.test_attacks import Running

WORD = "a long password"
HERE = "127.0.0.2"
"""An address that a test can listen on and that is not the usual one."""


@pytest.fixture
def running(tmp_path: Path) -> Iterator[Running]:
    found = Running(tmp_path, host=HERE, password=Password(WORD))
    yield found
    found.close()


def login(running: Running, word: str, **headers: str) -> Any:
    own = {"Origin": f"http://{HERE}:{running.server.port}"}
    path = f"/{running.server.token}/login"
    return running.get(path, method="POST", body=word.encode(), headers={**own, **headers})


def test_without_the_password_there_is_its_page_alone(running: Running) -> None:
    own = f"/{running.server.token}"
    page = running.get(f"{own}/").body.decode()
    assert 'type="password"' in page
    assert "dials" not in page, "not that of the bench"
    for path in ("made/x.step", "job/1", "talk"):
        assert running.code(f"{own}/{path}") == 401
    assert running.code("/wrong/") == 403, "nor without the token"
    with pytest.raises(HTTPClientError, match="401"):
        running.talk(json.dumps({"do": "hello"}))
    headers = {"Origin": f"http://{HERE}:{running.server.port}"}
    upload = f"{own}/upload?name=a.toml"
    assert running.code(upload, method="POST", body=b"x", headers=headers) == 401
    assert not (running.folder / "a.toml").exists()


def test_the_password_opens_it_by_a_cookie_that_scripts_and_other_sites_do_not_have(running: Running) -> None:
    found = login(running, WORD)
    cookie = found.headers["Set-Cookie"]
    for word in ("HttpOnly", "SameSite=Strict", f"Path=/{running.server.token}/"):
        assert word in cookie
    assert WORD not in cookie
    own = {"Cookie": cookie.partition(";")[0]}
    assert "dials" in running.get(f"/{running.server.token}/", headers=own).body.decode()


@pytest.mark.parametrize("cookie", ["", "x", "\u00e4", "=", f"{COOKIE}=guessed; {COOKIE}=again"])
def test_a_cookie_that_is_made_up_is_none(running: Running, cookie: str) -> None:
    headers = {"Cookie": f"{COOKIE}={cookie}"}
    assert running.code(f"/{running.server.token}/job/1", headers=headers) in (400, 401)


def test_guessing_ends_after_ten_tries(running: Running) -> None:
    for number in range(10):
        with pytest.raises(HTTPClientError, match="401"):
            login(running, f"guess number {number}")
    with pytest.raises(HTTPClientError, match="401"):
        login(running, WORD)


def test_another_site_cannot_log_in_and_no_other_name_is_taken(running: Running) -> None:
    with pytest.raises(HTTPClientError, match="403"):
        login(running, WORD, Origin="http://evil.example")
    for host in ("localhost", "127.0.0.1", "evil.example"):
        headers = {"Host": f"{host}:{running.server.port}"}
        assert running.code(f"/{running.server.token}/", headers=headers) == 403


@pytest.mark.parametrize("host", ["0.0.0.0", "example.org", "::1", "224.0.0.1", ""])
def test_only_one_address_of_this_machine_is_taken(host: str) -> None:
    with pytest.raises(CranktopoError, match="must be one IPv4 address"):
        check_host(host, knows=True)


def test_an_address_that_others_reach_needs_that_it_is_known_and_a_password(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["bench", "--host", "192.0.2.1", "--no-browser"]) != 0
    told = capsys.readouterr().err
    assert "not encrypted" in told
    assert "--i-know" in told
    assert main(["bench", "--i-know", "--no-browser"]) != 0
    with pytest.raises(CranktopoError, match="at least 10"):
        Password("short")
