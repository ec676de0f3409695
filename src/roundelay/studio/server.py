"""What the browser may ask for: one machine, one token, one page.

Nothing is served but under the token, to the address the studio was opened at, and to pages of
its own origin. Long work is answered line by line, each line an event as JSON; a browser that
goes away cancels it.
"""

from __future__ import annotations

import json
import os
import secrets
import socket
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import aclosing, asynccontextmanager, suppress
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, JSONResponse, Response, StreamingResponse
from starlette.routing import Mount, Route
from starlette.types import ASGIApp, Receive, Scope, Send

from roundelay.base.errors import Locked, in_one_line, input_errors
from roundelay.base.files import name_of, written_beside
from roundelay.base.texts import printable
from roundelay.base.version import __version__
from roundelay.studio.analyst import Analyst
from roundelay.studio.folder import Folder

__all__ = ["HOST", "LARGEST", "Address", "Studio", "application", "bound", "served"]

HOST = "127.0.0.1"
LARGEST = 256
"""Megabytes of a file that is dropped, unless more is allowed."""
# Bytes of a question that is no file.
_QUESTION = 4 << 20
_MEGABYTE = 1_000_000
_KINDS = {".js": "text/javascript", ".css": "text/css", ".html": "text/html"}
_HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
Answer = Callable[[Request], Awaitable[Response]]


@dataclass(frozen=True)
class Address:
    """Where the studio is reached.

    Parameters
    ----------
    port : int
    token : str
        Without it, nothing is answered.
    """

    port: int
    token: str

    @property
    def origin(self) -> str:
        """Scheme, host and port."""
        return f"http://{HOST}:{self.port}"

    @property
    def url(self) -> str:
        """What the browser opens."""
        return f"{self.origin}/{self.token}/"


class _Guard:
    """Refuse what does not come from the studio's own page."""

    def __init__(self, app: ASGIApp, address: Address) -> None:
        self._app, self._address = app, address

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        fault = self._fault(scope)
        if fault is None:
            await self._app(scope, receive, _with_headers(send))
        elif scope["type"] == "http":
            await _refusal(fault, 403)(scope, receive, _with_headers(send))

    def _fault(self, scope: Scope) -> str | None:
        """Say what is wrong with a question; None if nothing is."""
        if scope["type"] != "http":
            return "expected a question by HTTP"
        given = {key.decode("latin-1"): value.decode("latin-1") for key, value in scope["headers"]}
        if given.get("host") != f"{HOST}:{self._address.port}":
            return f"expected {self._address.origin} as the address, found another host"
        if given.get("origin", self._address.origin) != self._address.origin:
            return "expected a question of the studio's own page, found one of another origin"
        token = scope["path"].split("/")[1]
        if not secrets.compare_digest(token.encode(), self._address.token.encode()):
            return "expected the address that roundelay studio printed, found another token"
        return None


def _with_headers(send: Send) -> Send:
    async def sent(message: Any) -> None:
        if message["type"] == "http.response.start":
            own = [(key.lower().encode(), value.encode()) for key, value in _HEADERS.items()]
            message = message | {"headers": [*message["headers"], *own]}
        await send(message)

    return sent


def _refusal(line: str, status: int) -> Response:
    return JSONResponse({"error": line}, status)


class Studio:
    """Answer what the page asks.

    Parameters
    ----------
    folder : Folder
        Where takes and work are kept.
    analyst : Analyst
        Who reads them.
    exports : Path
        Where zips wait to be fetched.
    largest : float
        Megabytes that a file may have.
    """

    def __init__(
        self, folder: Folder, analyst: Analyst, exports: Path, largest: float = LARGEST
    ) -> None:
        self._folder, self._analyst = folder, analyst
        self._exports, self._largest = exports, largest

    @property
    def routes(self) -> list[Route]:
        """What is answered, below the token."""
        return [
            Route("/", self._page),
            Route("/client/{room}/{name}", self._module),
            Route("/api/takes", self._takes),
            Route("/api/takes/{name}", self._dropped, methods=["PUT"]),
            Route("/api/takes/{name}/work", self._kept, methods=["PUT"]),
            Route("/api/takes/{name}/open", self._opened, methods=["POST"]),
            Route("/api/takes/{name}/loops", self._remade, methods=["POST"]),
            Route("/api/takes/{name}/choices", self._choices, methods=["POST"]),
            Route("/api/takes/{name}/export", self._exported, methods=["POST"]),
            Route("/api/exports/{number}/{name}", self._fetched),
        ]

    async def _page(self, _: Request) -> Response:
        return _client("index.html")

    async def _module(self, request: Request) -> Response:
        room, name = request.path_params["room"], request.path_params["name"]
        if room not in ("studio", "page") or not name.replace("_", "").replace(".", "").isalnum():
            raise HTTPException(404, "expected a part of the page, found none of that name")
        return _client(name, room)

    async def _takes(self, _: Request) -> Response:
        return JSONResponse({
            "takes": self._folder.takes(),
            "folder": printable(str(self._folder.path)),
            "largest": self._largest,
            "version": __version__,
        })  # fmt: skip

    async def _dropped(self, request: Request) -> Response:
        """Keep a file that was dropped, unless it is larger than allowed."""
        name = request.path_params["name"]
        path, most = self._folder.place(name), round(self._largest * _MEGABYTE)
        told = int(request.headers.get("content-length", 0))
        if told > most:
            return _refusal(self._too_large(name, told), 413)
        held = 0
        with written_beside(path) as part, part.open("wb") as file:
            async for chunk in request.stream():
                held += len(chunk)
                if held > most:
                    raise HTTPException(413, self._too_large(name, held))
                file.write(chunk)
            # A browser that was closed in the middle leaves nothing.
            if held != told:
                raise HTTPException(400, f"{name}: expected {told} bytes, found {held}")
        return JSONResponse({"name": path.name})

    def _too_large(self, name: str, found: int) -> str:
        return (
            f"{name}: expected a file of at most {self._largest:g} MB, found "
            f"{found / _MEGABYTE:.0f} MB; allow more by --largest, or cut it"
        )

    async def _kept(self, request: Request) -> Response:
        asked = await _question(request)
        name = request.path_params["name"]
        revision = self._folder.keep(name, asked.get("work"), asked.get("revision", 0))
        return JSONResponse({"revision": revision})

    async def _opened(self, request: Request) -> Response:
        name = request.path_params["name"]
        path, (work, revision) = self._folder.existing(name), self._folder.work(name)
        first = {"name": name, "revision": revision, "stored": work is not None}
        return self._streamed(first, "open", str(path), work)

    async def _remade(self, request: Request) -> Response:
        asked = await _question(request)
        path = self._folder.existing(request.path_params["name"])
        return self._streamed({}, "remake", str(path), asked.get("work"), asked.get("places", []))

    async def _choices(self, request: Request) -> Response:
        asked = await _question(request)
        path = self._folder.existing(request.path_params["name"])
        return self._streamed({}, "choices", str(path), asked.get("work"), asked.get("place", 0))

    async def _exported(self, request: Request) -> Response:
        asked = await _question(request)
        name, target = request.path_params["name"], asked.get("target")
        path, number = self._folder.existing(name), secrets.token_hex(8)
        file = f"{name_of(path)}_{target or 'loops'}.zip"
        (self._exports / number).mkdir()
        archive = self._exports / number / "loops.zip"
        first = {"link": f"api/exports/{number}/{file}", "file": file}
        return self._streamed(first, "export", str(path), asked.get("work"), target, str(archive))

    async def _fetched(self, request: Request) -> Response:
        number, name = request.path_params["number"], request.path_params["name"]
        archive = self._exports / number / "loops.zip"
        if not number.isalnum() or not archive.is_file():
            raise HTTPException(404, "expected loops that were exported, found none of that name")
        return FileResponse(archive, media_type="application/zip", filename=name)

    def _streamed(self, first: dict[str, Any], job: str, *arguments: Any) -> Response:
        async def lines() -> AsyncIterator[bytes]:
            yield _line(first)
            async with aclosing(self._analyst.asked(job, *arguments)) as events:
                async for event in events:
                    yield _line(event)

        return StreamingResponse(lines(), media_type="application/x-ndjson")


def _line(event: dict[str, Any]) -> bytes:
    return json.dumps(event, separators=(",", ":"), allow_nan=False).encode() + b"\n"


async def _question(request: Request) -> dict[str, Any]:
    """Read a question, as JSON.

    Raises
    ------
    ValueError
        If it is too long, or no object.
    """
    held = b""
    async for chunk in request.stream():
        held += chunk
        if len(held) > _QUESTION:
            raise ValueError(f"expected a question of at most {_QUESTION / _MEGABYTE:.0f} MB")
    try:
        asked = json.loads(held)
    except (ValueError, RecursionError):
        raise ValueError("expected a question as JSON, found something else") from None
    if not isinstance(asked, dict):
        raise ValueError("expected a question as an object of JSON, found another value")
    return asked


def _client(name: str, room: str = "studio") -> Response:
    """Return a part of the page: of the studio, or what it shares with the page of `view`."""
    home = files("roundelay.studio") / "client" if room == "studio" else None
    home = home or files("roundelay.output.page")
    path = home / "modules" / name if name.endswith(".js") else home / name
    suffix = Path(name).suffix
    if suffix not in _KINDS or not path.is_file():
        raise HTTPException(404, f"expected a part of the page, found no {name}")
    return Response(path.read_bytes(), media_type=_KINDS[suffix])


async def _told(_: Request, error: Exception) -> Response:
    """Tell what is wrong in one line."""
    if isinstance(error, HTTPException):
        return _refusal(str(error.detail), error.status_code)
    if isinstance(error, ClientDisconnect):
        return _refusal("the browser went away", 400)
    return _refusal(" ".join(in_one_line(error).split()), 409 if isinstance(error, Locked) else 400)


def application(studio: Studio, address: Address, end: Callable[[], None]) -> ASGIApp:
    """Return what a server of ASGI serves.

    Parameters
    ----------
    studio : Studio
    address : Address
    end : callable
        Called when the server ends.
    """

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        yield
        end()

    kinds = (HTTPException, ClientDisconnect, *input_errors())
    inner = Starlette(
        routes=[Mount(f"/{address.token}", routes=studio.routes)],
        exception_handlers=dict.fromkeys(kinds, _told),
        lifespan=lifespan,
    )
    return _Guard(inner, address)


def bound(port: int) -> socket.socket:
    """Return a socket of this machine alone.

    Parameters
    ----------
    port : int
        0 for a free one.

    Raises
    ------
    OSError
        If the port is taken.
    """
    made = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    if os.name != "nt":  # there it would let others listen, too
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        made.bind((HOST, port))
    except OSError as error:
        made.close()
        error.filename = f"port {port}"
        raise
    return made


def served(
    folder: Path, *, port: int, largest: float, opened: Callable[[Address, Path], None]
) -> None:
    """Serve the studio until it is interrupted.

    Parameters
    ----------
    folder : Path
        Where takes and work are kept.
    port : int
        0 for a free one.
    largest : float
        Megabytes of a file that is dropped.
    opened : callable
        Told the address and the folder, once the studio can be reached.

    Raises
    ------
    OSError
        If the port is taken or the folder cannot be made.
    """
    kept = Folder(folder)
    with bound(port) as listening, TemporaryDirectory() as exports:
        address = Address(listening.getsockname()[1], secrets.token_urlsafe(24))
        analyst = Analyst()
        studio = Studio(kept, analyst, Path(exports), largest)
        config = uvicorn.Config(
            application(studio, address, analyst.end),
            log_level="error",
            access_log=False,
            server_header=False,
            date_header=False,
            timeout_graceful_shutdown=2,
        )
        listening.listen()
        opened(address, kept.path)
        sys.stdout.flush()
        with suppress(KeyboardInterrupt):
            uvicorn.Server(config).run(sockets=[listening])
