"""What the tests of the package share: a daemon of their own, and calls that may take long but must end."""

import os
import subprocess
import sys
import tempfile
import threading
import unittest

import awtd

BUILD = os.environ.get("AWTD_BUILD", "build/release")
TOP = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
PATIENCE_S = 60  # for what must end; nothing here takes that long


class WithDaemon(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.daemon = subprocess.Popen([os.path.join(BUILD, "awtd"), "--listen", "127.0.0.1:0", "--state-dir",
                                       cls.folder.name], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        cls.address = cls.daemon.stdout.readline().removeprefix("listening on ").strip()
        cls.token = os.path.join(cls.folder.name, "token")

    @classmethod
    def tearDownClass(cls):
        cls.daemon.terminate()
        cls.daemon.wait(30)
        cls.daemon.stdout.close()
        cls.folder.cleanup()

    def connect(self, address=None, **options):
        client = awtd.connect(address or self.address, self.token, **options)
        self.addCleanup(client.close)
        return client

    def path(self, *names):
        return os.path.join(self.folder.name, *names)

    def run_script(self, *arguments):
        return subprocess.run([sys.executable, "-B", *arguments], cwd=self.folder.name, text=True,
                              capture_output=True, timeout=PATIENCE_S)


def ended(call):
    """What the call raised, None where it raised nothing. Fails where it does not end."""
    result = []

    def run():
        try:
            call()
            result.append(None)
        except Exception as error:  # what it is is for the test
            result.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(PATIENCE_S)
    if not result:
        raise AssertionError(f"it did not end in {PATIENCE_S} s")
    return result[0]
