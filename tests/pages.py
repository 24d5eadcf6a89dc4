"""Pages that explore maps, served to tests."""

import contextlib
import http.client
import threading
from collections.abc import Iterator, Mapping

import frictionmap as fm
from frictionmap.explorer.packets import unpack
from frictionmap.explorer.scene import Scene, scene_of
from frictionmap.explorer.server import Server, open_server
from frictionmap.files.config import load_config

#: Seconds after which what does not come counts as hung, on a machine ten times as slow as a slow one.
HANG = 120.0

#: A configuration of one mass.
ONE = """\
title = "One mass"
[system]
contact = "fixed-wall"
[grid]
r = [0.0, 2.0]
beta = [0.0, 1.2]
mu = [1.0, 1.5]
"""

#: A configuration whose contact is between the masses.
TWO_MASSES = """\
[system]
contact = "between-masses"
contact_masses = [1, 2]
mass_ratios = [1.0, 0.5]
stiffness_ratios = [1.0, 2.0]
[grid]
r = [0.1, 2.5]
beta = [0.0, 2.0]
"""


def scene_from(folder, text: str) -> Scene:
    """The scene of a configuration."""
    path = folder / "scene.toml"
    path.write_text(text)
    return scene_of(load_config(path))


@contextlib.contextmanager
def served(scene: Scene) -> Iterator[Server]:
    """A server of a scene, at any port that is free."""
    server = open_server(scene, 0)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield server
    finally:
        server.shutdown()
        thread.join()
        server.close()


def ask(
    server: Server, target: str, headers: Mapping[str, str] | None = None, method: str = "GET"
) -> tuple[int, bytes, Mapping[str, str]]:
    """Status, body and headers of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=HANG)
    with contextlib.closing(connection):
        connection.request(method, target, headers=dict(headers or {}))
        answer = connection.getresponse()
        return answer.status, answer.read(), dict(answer.getheaders())


def packet(server: Server, target: str):
    """Header and arrays of an answer."""
    status, body, _ = ask(server, target)
    assert status == 200, body
    return unpack(body)


def solver(**settings) -> fm.Solver:
    """Settings of maps as the page wants them."""
    return fm.Solver(outputs=("regime", "stops_per_cycle"), **settings)
