"""The server of asyncua on a free port of this machine, in a thread of its own; starting it takes seconds."""

import asyncio
import copy
import threading

from asyncua import Server, ua
from asyncua.crypto.permission_rules import User, UserRole
from cryptography.hazmat.primitives.serialization import Encoding

from tests.opcua.certificates import URI

POLICIES = [
    ua.SecurityPolicyType.NoSecurity,
    ua.SecurityPolicyType.Basic256Sha256_Sign,
    ua.SecurityPolicyType.Basic256Sha256_SignAndEncrypt,
    ua.SecurityPolicyType.Aes256Sha256RsaPss_SignAndEncrypt,
]


class AsyncuaServer:
    """Server with one variable; what it shows and whom it knows can be changed while it runs."""

    def __init__(self, pair):
        self.users, self._ended = {}, threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._run(pair)), daemon=True)
        started = threading.Event()
        self._started = started.set
        self._thread.start()
        assert started.wait(180)

    async def _run(self, pair):
        self.server = Server(user_manager=self)
        await self.server.init()
        self.server.set_endpoint("opc.tcp://127.0.0.1:0/plant")
        await self.server.set_application_uri(URI)
        self.server.set_security_policy(POLICIES)
        await self.server.load_certificate(str(pair.der))
        await self.server.load_private_key(pair.pem, None, "pem")
        await self.server.nodes.objects.add_variable(ua.NodeId("PV", 2), "PV", 1.5)
        await self.server.start()
        self.address = f"opc.tcp://127.0.0.1:{self.server.bserver._server.sockets[0].getsockname()[1]}/plant"
        self._all = copy.deepcopy(self.server.iserver.endpoints)
        self._started()
        await asyncio.to_thread(self._ended.wait)
        await self.server.stop()

    def get_user(self, _server, username=None, password=None, certificate=None):
        """User by name and password; where none are known, anybody."""
        if not self.users or (username in self.users and self.users[username] == password):
            return User(role=UserRole.User, name=username)
        return None

    @property
    def endpoints(self):
        """What it offers, as clients will see it."""
        return self.server.iserver.endpoints

    def reset(self):
        """As it was at the beginning."""
        self.users.clear()
        self.endpoints[:] = copy.deepcopy(self._all)

    def shows(self, certificate):
        """From now on this certificate before a session; the key stays."""
        for endpoint in self.endpoints:
            endpoint.ServerCertificate = certificate.public_bytes(Encoding.DER)

    def offers(self, *wanted):
        """From now on these modes and policies only: (mode, part of the name of the policy)."""
        self.endpoints[:] = [
            one for one in self.endpoints
            if any(one.SecurityMode.name == mode and name in one.SecurityPolicyUri for mode, name in wanted)
        ]  # fmt: skip

    def close(self):
        """Stop it."""
        self._ended.set()
        self._thread.join(60)
