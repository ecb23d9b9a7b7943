// harness.mjs: awtd, the gateway, and checks for the tests of both. A check prints what it saw and goes on; `finish` prints the count.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

export const top = fileURLToPath(new URL('../..', import.meta.url));
export const build = process.argv[2] ?? 'build/release';
const WAIT_MS = 60000;
const counts = { passed: 0, failed: 0, skipped: 0 };
const running = new Set();
process.on('exit', () => running.forEach(({ child }) => child.kill())); /* whatever ends the tests */
let what = '', sound = true;

export function check(value, text) {
  if (!value) {
    sound = false;
    console.log(`     ${what}: ${text}`);
  }
}

export function equal(seen, expected, text) {
  check(Object.is(seen, expected), `${text}: ${String(seen)}, not ${String(expected)}`);
}

/** Runs a test; what it throws fails it. Only those whose name contains the second argument, where there is one. */
export async function test(name, run) {
  if (process.argv[3] && !name.includes(process.argv[3])) {
    return;
  }
  what = name;
  sound = true;
  const begin = Date.now();
  try {
    await run();
  } catch (error) {
    check(false, error.stack);
  }
  counts[sound ? 'passed' : 'failed']++;
  console.log(`${sound ? 'ok  ' : 'FAIL'} ${name} (${((Date.now() - begin) / 1000).toFixed(1)} s)`);
}

/** Waits for what `look` returns to be true; it may return a promise. `text`: what for, or a function that says it. */
export async function until(look, text) {
  const end = Date.now() + WAIT_MS;
  for (;;) {
    const seen = await look();
    if (seen) {
      return seen;
    }
    if (Date.now() > end) {
      throw new Error(`waited in vain: ${typeof text === 'function' ? await text() : text}`);
    }
    await new Promise((resolve) => setTimeout(resolve, 30));
  }
}

/** A program that has said that it listens: { port, output, stop }. */
export async function start(command, args) {
  const child = spawn(command, args, { cwd: top, stdio: ['ignore', 'pipe', 'pipe'] });
  const program = { child, output: '', port: 0, stop: () => stop(program) };
  running.add(program);
  child.stdout.on('data', (bytes) => { program.output += bytes; });
  child.stderr.on('data', (bytes) => { program.output += bytes; });
  program.ended = new Promise((resolve) => child.on('close', resolve));
  const [, port] = await until(() => /listening on \S+:(\d+)[^]*\n/.exec(program.output) ?? (child.exitCode !== null && [0, 0]), `${command} listens`);
  if (!port) {
    throw new Error(`${command} ended: ${program.output}`);
  }
  program.port = Number(port);
  return program;
}

async function stop(program) {
  program.child.kill('SIGTERM');
  await program.ended;
  running.delete(program);
}

const work = mkdtempSync(join(tmpdir(), 'awt-web-'));
export const startAwtd = (port = 0, ...more) => start(join(build, 'awtd'), ['--listen', `127.0.0.1:${port}`, '--state-dir', join(work, 'state'), ...more]);

/** With its addresses: { drive, view } as pages, and { tokens }. */
export async function startGateway(daemonPort, ...more) {
  const gateway = await start('node', ['clients/web/gateway.mjs', '--listen', '127.0.0.1:0', '--connect', `127.0.0.1:${daemonPort}`,
    '--token-file', join(work, 'state/token'), '--build', build, ...more]);
  await until(() => /view: \S+/.test(gateway.output), 'the addresses');
  gateway.drive = /drive: (\S+)/.exec(gateway.output)[1];
  gateway.view = /view: (\S+)/.exec(gateway.output)[1];
  gateway.tokens = { drive: gateway.drive.split('token=')[1], view: gateway.view.split('token=')[1] };
  gateway.origin = new URL(gateway.drive).origin;
  return gateway;
}

export function skip(count, why) {
  counts.skipped += count;
  console.log(`skip ${why}`);
}

export async function finish() {
  await Promise.all([...running].map(stop));
  rmSync(work, { recursive: true, force: true });
  console.log(`${counts.passed} passed, ${counts.failed} failed, ${counts.skipped} skipped`);
  process.exit(counts.failed > 0 ? 1 : 0);
}
