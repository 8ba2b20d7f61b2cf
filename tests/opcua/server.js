// An OPC UA server that is not ours (node-opcua) with one simulated loop, driven by lines of JSON.
//
// The first line on standard input is the configuration; each later one is a command; each answer is a line of JSON on
// standard output. What the library itself prints goes to standard error. It ends when standard input does.
"use strict";
for (const name of ["log", "info", "debug", "warn"]) console[name] = (...words) => console.error(...words);
const readline = require("node:readline");
const fs = require("node:fs");
const path = require("node:path");
const opcua = require("node-opcua");
const { DataType, StatusCodes } = opcua;

const say = (answer) => process.stdout.write(JSON.stringify(answer) + "\n");
const TAGS = ["OP", "PV", "SP"];

// Store of certificates of clients; its own key, which nobody uses, is not made anew each time.
async function manager(config, name, accept) {
    const folder = path.join(config.folder, name);
    const own = path.join(folder, "own", "private");
    fs.mkdirSync(own, { recursive: true });
    fs.copyFileSync(config.key, path.join(own, "private_key.pem"));
    const made = new opcua.OPCUACertificateManager({
        rootFolder: folder, automaticallyAcceptUnknownCertificate: accept, disableFileWatchers: true, keySize: 2048,
    });
    await made.initialize();
    for (const one of config.clients ?? []) await trust(made, one);
    return made;
}

async function trust(store, file) {
    await store.trustCertificate(fs.readFileSync(file));
}

async function makeServer(config) {
    const server = new opcua.OPCUAServer({
        hostname: "127.0.0.1", port: config.port ?? 0, resourcePath: config.path ?? "/plant",
        serverInfo: { applicationUri: config.uri, productUri: "urn:lostmotion:tests" },
        certificateFile: config.certificate, privateKeyFile: config.key, nodeset_filename: [opcua.nodesets.standard],
        serverCertificateManager: await manager(config, "server", config.accept ?? false),
        userCertificateManager: await manager(config, "users", false),
        securityModes: config.modes.map((mode) => opcua.MessageSecurityMode[mode]),
        securityPolicies: config.policies.map((policy) => opcua.SecurityPolicy[policy]),
        allowAnonymous: config.anonymous ?? false,
        userManager: { isValidUser: (name, password) => (config.users ?? {})[name] === password },
        serverCapabilities: { maxSessions: 50 },
    });
    await server.initialize();
    return server;
}

function addLoop(server, tag) {
    const space = server.engine.addressSpace;
    const own = space.getOwnNamespace();
    const loop = own.addObject({ organizedBy: space.rootFolder.objects, browseName: tag });
    const nodes = {};
    for (const name of TAGS) {
        nodes[name] = own.addVariable({
            componentOf: loop, browseName: name, nodeId: `s=${tag}.${name}`, dataType: "Double", minimumSamplingInterval: 0,
        });
        space.installHistoricalDataNode(nodes[name], { maxOnlineValues: 20000 });
    }
    return nodes;
}

// The variables of a supervised block, which does not scan: all of one type, but for a flag; some that cannot be
// written, some whose value the controller refuses. What was written is kept in its order.
function addBlock(server, tag, config, written) {
    const own = server.engine.addressSpace.getOwnNamespace();
    const block = own.addObject({ organizedBy: server.engine.addressSpace.rootFolder.objects, browseName: tag });
    for (const name of config.names) {
        const type = name === "ACCEPT" ? "Boolean" : config.type;
        const held = { dataType: DataType[type], value: { Boolean: false, String: "" }[type] ?? 0 };
        const open = (config.readonly ?? []).includes(name) ? "CurrentRead" : "CurrentRead | CurrentWrite";
        const set = (variant) => {
            if ((config.refused ?? []).includes(name)) return StatusCodes.BadOutOfRange;
            held.value = variant.value;
            written.push([`${tag}.${name}`, DataType[variant.dataType], variant.value]);
            return StatusCodes.Good;
        };
        own.addVariable({
            componentOf: block, browseName: name, nodeId: `s=${tag}.${name}`, dataType: type, accessLevel: open,
            userAccessLevel: open, value: { get: () => new opcua.Variant(held), set },
        });
    }
}

// One value with its source time; the server time is now.
function put(node, value, at, quality) {
    node.setValueFromSource({ dataType: DataType.Double, value }, StatusCodes[quality ?? "Good"], new Date(at));
}

// Numbers that are the same at each start.
function random(seed) {
    let state = seed >>> 0;
    return () => {
        state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
        return state / 4294967296 - 0.5;
    };
}

// Flow loop with a PI controller and a valve with backlash.
class Loop {
    constructor(nodes, config) {
        Object.assign(this, { nodes, step: config.step ?? 0.1, width: config.width ?? 4, samples: [], quality: "Good" });
        Object.assign(this, { noise: random(config.seed ?? 1), pv: 50, op: 50, valve: 50, sum: 50, count: 0, timer: null });
        this.at = Date.now() + 2000 * this.step; // the first sample apart from the values of the start
    }

    advance() {
        const sp = 50 + (Math.floor(this.count / 60) % 2 ? 6 : -6);
        const error = sp - this.pv;
        this.sum += 0.08 * error;
        this.op = Math.min(100, Math.max(0, this.sum + 0.4 * error));
        this.valve = Math.min(Math.max(this.valve, this.op - this.width / 2), this.op + this.width / 2);
        this.pv += 0.3 * (this.valve - this.pv) + 0.2 * this.noise();
        const row = [this.at, this.op, this.pv, sp, this.quality];
        for (let k = 0; k < TAGS.length; k++) put(this.nodes[TAGS[k]], row[k + 1], this.at, this.quality);
        this.samples.push(row);
        this.count += 1;
        this.at += Math.round(1000 * this.step);
    }

    run() {
        this.at = Math.ceil(Date.now() / (1000 * this.step)) * 1000 * this.step;
        const due = () => {
            while (this.at <= Date.now()) this.advance();
        };
        this.timer = setInterval(due, Math.max(5, 250 * this.step));
    }
}

async function answer(one, asked) {
    const { server, loop } = one;
    if (asked.do === "put") put(loop.nodes[asked.tag], asked.value, asked.at ?? Date.now(), asked.quality);
    else if (asked.do === "advance") for (let k = 0; k < asked.steps; k++) loop.advance();
    else if (asked.do === "run") loop.run();
    else if (asked.do === "pause") clearInterval(loop.timer);
    else if (asked.do === "quality") loop.quality = asked.is;
    else if (asked.do === "trust") await trust(server.serverCertificateManager, asked.file);
    else if (asked.do === "samples") return { samples: loop.samples };
    else if (asked.do === "written") return { written: one.written.splice(0) };
    else return { error: `no such command: ${asked.do}` };
    return { done: asked.do };
}

async function main() {
    const lines = readline.createInterface({ input: process.stdin })[Symbol.asyncIterator]();
    const configs = JSON.parse((await lines.next()).value);
    const all = {};
    for (const [name, config] of Object.entries(configs)) {
        const server = await makeServer(config);
        all[name] = { server, loop: new Loop(addLoop(server, config.tag ?? "FIC101"), config), written: [] };
        for (const [tag, block] of Object.entries(config.blocks ?? {})) addBlock(server, tag, block, all[name].written);
        await server.start();
    }
    const ports = Object.entries(all).map(([name, one]) => [name, one.server.endpoints[0].port]);
    say({ ready: Object.fromEntries(ports) });
    for (let line = await lines.next(); !line.done; line = await lines.next()) {
        const asked = JSON.parse(line.value);
        say(await answer(all[asked.of ?? "plant"], asked));
    }
    process.exit(0);
}

main().catch((error) => {
    say({ error: String(error && error.stack) });
    process.exit(1);
});
