#!/usr/bin/env python3
"""A client of `hydrapod serve`, with Python's standard library alone.

    hydrapod serve machine.toml --once &
    python3 client.py 127.0.0.1 4747 [KEYFILE]

Moves the platform up and down by 2 mm for two seconds and prints every tenth sample: time [s],
demanded and actual displacement in z [mm], length of leg 1 [mm]. The layout of the packets is
printed by `hydrapod serve machine.toml --print-layout`.
"""

import hashlib
import hmac
import math
import socket
import struct
import sys
import time
import zlib

HELLO, POSE, VALVES, LEAVE = range(4)
COMMAND = struct.Struct("<IHBBQQQ30d")  # magic … time; displacement, rate, drive, wrench, next
SENSORS = struct.Struct("<IHBxQQQQQ11I4x55d")  # magic … counters; values; accelerometers follow
MAGIC_COMMAND, MAGIC_SENSORS, VERSION = 0x43445948, 0x53445948, 1
STATES = ["waiting", "following", "holding", "ramping", "parked"]


class Client:
    def __init__(self, host, port, key=b""):
        self.key = key
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect((host, port))
        self.socket.settimeout(0.2)
        self.session = self.sequence = 0
        for _ in range(25):  # the server may still be starting
            try:
                self.send(HELLO)
                hello = self.receive()
                self.session, self.sequence = hello["session"], hello["answered"]
                return
            except (TimeoutError, ConnectionRefusedError):
                time.sleep(0.2)
        sys.exit("no answer")

    def send(self, mode, displacement=(0.0,) * 6, rate=(0.0,) * 6, drive=(0.0,) * 6):
        if mode != HELLO:
            self.sequence += 1
        values = [*displacement, *rate, *drive, *[0.0] * 12]
        body = COMMAND.pack(MAGIC_COMMAND, VERSION, mode, 0, self.session,
                            self.sequence if mode != HELLO else 0, time.monotonic_ns(), *values)
        body += struct.pack("<I", zlib.crc32(body))
        if self.key:
            body += hmac.new(self.key, b"C" + body, hashlib.sha256).digest()
        self.socket.send(body)

    def receive(self):
        """The next sound packet of sensors as a dictionary; TimeoutError where none comes."""
        while True:
            body = self.socket.recv(2048)
            if self.key:
                body, mac = body[:-32], body[-32:]
                right = hmac.new(self.key, b"S" + body, hashlib.sha256).digest()
                if not hmac.compare_digest(mac, right):
                    continue
            if len(body) < SENSORS.size + 4 or zlib.crc32(body[:-4]) != int.from_bytes(
                    body[-4:], "little"):
                continue
            f = SENSORS.unpack_from(body)
            if f[0] != MAGIC_SENSORS or f[1] != VERSION:
                continue
            return {"state": STATES[f[2]], "session": f[3], "sequence": f[4], "time": f[5] * 1e-9,
                    "answered": f[6], "misses": f[8], "length": f[19:25], "platform": f[55:61]}


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    key = open(sys.argv[3], "rb").read() if len(sys.argv) == 4 else b""
    client = Client(sys.argv[1], int(sys.argv[2]), key)
    omega, size = 2.0 * math.pi * 0.5, 0.001
    client.send(POSE)
    start = None
    print("time,demand_mm,platform_mm,leg1_mm")
    while True:
        try:
            sensors = client.receive()
        except TimeoutError:
            sys.exit("the server is silent")
        start = sensors["time"] if start is None else start
        t = sensors["time"] - start
        z, speed = size * (1.0 - math.cos(omega * t)), size * omega * math.sin(omega * t)
        if sensors["sequence"] % 10 == 0:
            print(f"{t:.3f},{1e3 * z:.4f},{1e3 * sensors['platform'][2]:.4f},"
                  f"{1e3 * sensors['length'][0]:.4f}")
        if t >= 2.0:
            break
        client.send(POSE, (0.0, 0.0, z, 0.0, 0.0, 0.0), (0.0, 0.0, speed, 0.0, 0.0, 0.0))
    client.send(LEAVE)


if __name__ == "__main__":
    main()
