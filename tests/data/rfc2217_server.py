"""Serves a serial port by RFC 2217 to one client after the other, with pyserial: rfc2217_server.py TTY PORT."""

import socket
import sys
import threading

import serial
import serial.rfc2217


class Connection:
    """What pyserial's port manager writes to."""

    def __init__(self, client):
        self.client = client
        self.lock = threading.Lock()

    def write(self, data):
        with self.lock:
            self.client.sendall(data)


def serve(port, client):
    client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    connection = Connection(client)
    manager = serial.rfc2217.PortManager(port, connection)
    # A pseudo-terminal has no modem lines to report.
    manager.check_modem_lines = lambda force_notification=False: None
    ended = threading.Event()

    def to_client():
        while not ended.is_set():
            data = port.read(port.in_waiting or 1)
            if data:
                connection.write(b"".join(manager.escape(data)))

    reader = threading.Thread(target=to_client, daemon=True)
    reader.start()
    while data := client.recv(1024):
        port.write(b"".join(manager.filter(data)))
    ended.set()
    reader.join()


def main():
    tty, number = sys.argv[1:]
    port = serial.serial_for_url(tty, timeout=0.1)
    with socket.create_server(("127.0.0.1", int(number))) as server:
        while True:
            client, _ = server.accept()
            with client:
                serve(port, client)


main()
