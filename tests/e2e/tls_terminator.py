"""tls_terminator.py CERTIFICATE KEY HOST:PORT: takes TLS on a free loopback port, which it prints, and passes the bytes on."""
import select
import socket
import ssl
import sys
import threading


def take(end):
    """What has come; b'': nothing now; None: it has ended."""
    try:
        return end.recv(65536) or None
    except (ssl.SSLWantReadError, ssl.SSLWantWriteError, BlockingIOError):
        return b""
    except OSError:
        return None


def give(end, data):
    """All of it, however often the end says not now. False: it has ended."""
    while data:
        try:
            data = data[end.send(data):]
        except (ssl.SSLWantWriteError, BlockingIOError):
            select.select([], [end], [])
        except ssl.SSLWantReadError:
            select.select([end], [], [])
        except OSError:
            return False
    return True


def serve(plain, context, host, port):
    try:
        client = context.wrap_socket(plain, server_side=True)
    except OSError:
        return
    daemon = socket.create_connection((host, port))
    client.setblocking(False)
    daemon.setblocking(False)
    other = {client: daemon, daemon: client}
    alive = True
    while alive:
        ready = [client] if client.pending() else select.select([client, daemon], [], [])[0]
        for end in ready:
            data = take(end)
            alive = alive and data is not None and give(other[end], data)
    client.close()
    daemon.close()


context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
context.load_cert_chain(sys.argv[1], sys.argv[2])
host, port = sys.argv[3].rsplit(":", 1)
listener = socket.create_server(("127.0.0.1", 0))
print("listening on 127.0.0.1:%d" % listener.getsockname()[1], flush=True)
while True:
    threading.Thread(target=serve, args=(listener.accept()[0], context, host, int(port)), daemon=True).start()
