"""Access to a bench that other machines can reach: a password, asked once by each browser."""

from __future__ import annotations

import hashlib
import hmac
import ipaddress
import secrets

from cranktopo.base.errors import CranktopoError

COOKIE = "cranktopo_bench"
LEAST_LETTERS = 10
_MOST_WRONG = 10
_COST, _BLOCK, _MEMORY = 2**14, 8, 64 << 20
"""Of scrypt, RFC 7914: some 50 ms a guess."""


class Password:
    """A password, kept as a hash, and the secret that a browser holds after it gave it."""

    def __init__(self, text: str) -> None:
        """Take a password; raises CranktopoError for one that is too short."""
        if len(text) < LEAST_LETTERS:
            raise CranktopoError(f"password: must have at least {LEAST_LETTERS} letters.")
        self._salt, self._cookie, self._wrong = secrets.token_bytes(16), secrets.token_urlsafe(24), 0
        self._hash = self._hashed(text)

    def cookie_for(self, text: str) -> str | None:
        """Return the secret for a browser that gives this; None where it is wrong, or ten were."""
        if self._wrong >= _MOST_WRONG:
            return None
        if hmac.compare_digest(self._hashed(text), self._hash):
            return self._cookie
        self._wrong += 1
        return None

    def admits(self, cookie: str | None) -> bool:
        """Return True for the secret of a browser that gave the password."""
        return cookie is not None and hmac.compare_digest(cookie.encode(), self._cookie.encode())

    def _hashed(self, text: str) -> bytes:
        return hashlib.scrypt(text.encode(), salt=self._salt, n=_COST, r=_BLOCK, p=1, maxmem=_MEMORY)


def check_host(host: str, knows: bool) -> None:
    """Refuse an address that is none of one machine, or that others reach where the user does not know it.

    Raises:
        CranktopoError: as said.
    """
    try:
        address = ipaddress.IPv4Address(host)
    except ValueError:
        address = None
    if address is None or address.is_unspecified or address.is_multicast:
        raise CranktopoError(
            f"--host {host}: must be one IPv4 address of this machine.", hint="For example 192.168.1.20."
        )
    if not address.is_loopback and not knows:
        raise CranktopoError(
            f"--host {host}: other machines reach the bench there, and what is said is not encrypted.",
            hint="Add --i-know in a network that you trust, or leave both out and use an SSH tunnel.",
        )
