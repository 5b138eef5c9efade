"""A process that prints lines of JSON, which may abort or hang."""

import json
import queue
import subprocess
import threading


class Process:
    """`log`: a file that gets what the process prints to its standard error."""

    def __init__(self, command, log, environment=None):
        self._log = open(log, "a")
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._log, text=True, env=environment)
        self._lines = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in self._process.stdout:
            if line.startswith("{"):
                self._lines.put(json.loads(line))
        self._lines.put(None)

    def next(self, limit):
        """The next line, or what stopped the process."""
        try:
            line = self._lines.get(timeout=limit)
        except queue.Empty:
            line = {"stopped": "hangs"}
        return {"stopped": "aborts"} if line is None else line

    def ask(self, question, limit):
        """The line that answers a line."""
        try:
            self._process.stdin.write(question + "\n")
            self._process.stdin.flush()
        except BrokenPipeError:
            return {"stopped": "aborts"}
        return self.next(limit)

    def end(self):
        self._process.kill()
        self._process.wait()
        self._log.close()
