"""What comes in: files of any kind, text of any encoding; one clear line for what cannot be used."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.files import check_input, from_json, read_bytes, read_text_file


@pytest.mark.parametrize("content", [b"a = 1", b"\xef\xbb\xbfa = 1"], ids=["plain", "byte-order mark"])
def test_text(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x").write_bytes(content)
    assert read_text_file(tmp_path / "x", "design") == "a = 1"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"a = 1\nb = \xff", "is not text in UTF-8: line 2. Save it as UTF-8."),
        (b"a\0b", "it holds NUL bytes"),
        ("a = 1".encode("utf-16"), "is not text"),
        (b" " * 1025 * 1024, "is larger than 1 MiB"),
    ],
    ids=["latin-1", "NUL", "utf-16", "large"],
)
def test_what_is_not_text(tmp_path: Path, content: bytes, message: str) -> None:
    (tmp_path / "x").write_bytes(content)
    with pytest.raises(CranktopoError) as caught:
        read_text_file(tmp_path / "x", "design", limit_MiB=1)
    assert message in str(caught.value)
    assert str(caught.value).startswith("design: ")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("nothing", "No such file"),
        ("folder", "is a folder"),
        ("pipe", "is a pipe"),
        ("loop", "cannot be read: Too many levels"),
        ("x" * 300, "cannot be read: File name too long"),
        ("a\0b", "no file name may hold a NUL"),
        ("folder/../file/x", "Not a directory"),
    ],
)
def test_what_is_no_file(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to("loop")
    for read in (read_text_file, read_bytes, check_input):
        with pytest.raises(CranktopoError, match=message):
            read(tmp_path / name, "design", 1)


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/null"])
def test_devices(device: str) -> None:
    with pytest.raises(CranktopoError, match="is a device"):
        read_text_file(device, "design")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_no_permission(tmp_path: Path) -> None:
    (tmp_path / "x").touch(mode=0)
    with pytest.raises(CranktopoError, match="Permission denied"):
        read_text_file(tmp_path / "x", "design")


def test_values_in_messages() -> None:
    assert quoted(True) == "true"
    assert quoted("a\nb") == r"'a\nb'"
    assert len(quoted("x" * 10_000)) < 130
    assert quoted(16**5000) == "a number of about 6021 digits"
    assert quoted([1, 16**5000]) == "a number of thousands of digits"


@pytest.mark.parametrize("text", ["[" * 101 + "]" * 101, '{"a": ' * 101 + "1" + "}" * 101, "[" * 10**6])
def test_json_of_too_many_levels(text: str) -> None:
    """Some versions of Python read 2000 levels, and what walks them ends by a RecursionError."""
    with pytest.raises(ValueError, match="more than 100 levels"):
        from_json(text)
    assert from_json("[" * 99 + "1" + "]" * 99)
