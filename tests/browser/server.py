"""A JupyterLab of the tests' own: loopback only, its own folders, none of the user's settings."""

import json
import os
import secrets
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path

SETTINGS = {
    "apputils-extension/notification": {"fetchNews": "false", "checkForUpdates": False},
    "docmanager-extension/plugin": {"autosave": False},
    "notebook-extension/tracker": {"kernelShutdown": False},
}
THEME = "apputils-extension/themes"


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


class Server:
    """A running JupyterLab. ``url`` is where, ``root`` the folder of its notebooks, ``token`` the key to it."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.root = folder, folder / "root"
        self.url, self.token = f"http://127.0.0.1:{free_port()}", secrets.token_hex(16)
        self.root.mkdir()
        for name, values in SETTINGS.items():
            self._settings(name).parent.mkdir(parents=True, exist_ok=True)
            self._settings(name).write_text(json.dumps(values))
        command = [
            *(sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--expose-app-in-browser"),
            *("--ip=127.0.0.1", f"--port={self.url.rpartition(':')[2]}", "--ServerApp.port_retries=0"),
            *(f"--ServerApp.root_dir={self.root}", f"--IdentityProvider.token={self.token}"),
            "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate",
        ]
        # In a session of its own: Ctrl-C is for pytest, which stops it.
        with open(folder / "log", "w") as log:
            self.process = subprocess.Popen(
                command, env=self._environment(), stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True
            )

    def _environment(self) -> dict[str, str]:
        """No setting, kernelspec, signature or history of the user's gets in, and none of the tests' gets out."""
        rooms = {
            "JUPYTER_CONFIG_DIR": "config",
            "JUPYTER_DATA_DIR": "data",
            "JUPYTER_RUNTIME_DIR": "runtime",
            "JUPYTERLAB_SETTINGS_DIR": "settings",
            "JUPYTERLAB_WORKSPACES_DIR": "workspaces",
            "IPYTHONDIR": "ipython",
        }
        return os.environ | {name: str(self.folder / room) for name, room in rooms.items()}

    def _settings(self, name: str) -> Path:
        return self.folder / "settings" / "@jupyterlab" / f"{name}.jupyterlab-settings"

    def log(self) -> str:
        return (self.folder / "log").read_text()

    def wait(self, seconds: float = 60) -> None:
        """Until it answers."""
        last = time.monotonic() + seconds
        while time.monotonic() < last and self.process.poll() is None:
            try:
                return self.ask("/api/status") and None
            except urllib.error.URLError:
                time.sleep(0.03)
        raise RuntimeError(f"JupyterLab did not start:\n{self.log()[-3000:]}")

    def ask(self, path: str, method: str = "GET", body: object = None) -> object:
        """The server's answer to a request of its REST interface."""
        data = None if body is None else json.dumps(body).encode()
        headers = {"Authorization": f"token {self.token}"}
        request = urllib.request.Request(self.url + path, data, headers, method=method)
        with urllib.request.urlopen(request, timeout=30) as answer:
            return json.loads(answer.read() or "null")

    def reset(self) -> None:
        """No kernel runs, and the theme is the light one: what a test finds is not what the last one left."""
        for kernel in self.ask("/api/kernels"):
            self.ask(f"/api/kernels/{kernel['id']}", "DELETE")
        self._settings(THEME).unlink(missing_ok=True)

    def stop(self) -> None:
        """The server takes its kernels along; a kernel whose server was killed ends itself."""
        self.process.terminate()
        try:
            self.process.wait(15)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
