// browser.mjs: the viewer in Chromium, small and without smoothing, drawn in software: pages, pixels, what the page knows.
import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { until } from './harness.mjs';

const CHROMIUM = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
const FLAGS = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
  '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];
const require = createRequire(import.meta.url);

/** A browser, or null with the reason. */
export async function openBrowser() {
  let playwright;
  try {
    playwright = require('playwright-core');
  } catch {
    return { browser: null, why: 'the packages of tests/web are not here' };
  }
  return CHROMIUM ? { browser: await playwright.chromium.launch({ executablePath: CHROMIUM, args: FLAGS }) } : { browser: null, why: 'chromium is not here' };
}

/** The viewer at an address; `errors` gathers what the browser complains of. */
export class View {
  static async open(browser, address, { width = 640, height = 360, more = '&strands=600&smooth=0&coarse=1&bare=1' } = {}) {
    const view = new View();
    view.page = await browser.newPage({ viewport: { width, height } });
    view.errors = [];
    view.page.on('pageerror', (error) => view.errors.push(error.message));
    view.page.on('console', (message) => message.type() === 'error' && view.errors.push(message.text()));
    await view.page.goto(address + more, { timeout: 60000 });
    return view;
  }

  /** What the page knows of its hair. */
  knows() {
    return this.page.evaluate(() => {
      const { hair, driver } = globalThis.viewer ?? {}, { stats = {}, state, reason, forest } = hair ?? {};
      return { ...stats, state, reason, driving: driver?.driving, forest: String(forest?.handle), time_us: Number(stats.time_us ?? 0), sequence: Number(stats.sequence ?? 0) };
    });
  }

  untilIt(matches, text) {
    return until(async () => {
      const known = await this.knows();
      return matches(known) && known;
    }, text);
  }

  untilLive() {
    return this.untilIt(({ state, frames }) => state === 'live' && frames > 0, 'hair');
  }

  /** Stands still: no more steps, no more pictures of its own. */
  async hold() {
    await this.page.evaluate(() => { viewer.driver.paused = true; viewer.stage.renderer.setAnimationLoop(null); });
    await until(() => this.page.evaluate(() => !viewer.hair.stepping), 'the last step');
  }

  async goOn() {
    await this.page.evaluate(() => { viewer.driver.paused = false; });
  }

  /** Brings hair and head on by steps of 1/60 s, and waits until the hair of the last one is on the page. */
  async steps(count) {
    await this.page.evaluate(async (n) => {
      for (let i = 0; i < n; i++) {
        await viewer.driver.advance(1 / 60);
      }
    }, count);
    const wanted = await this.page.evaluate(() => Number(viewer.hair.time_us));
    await this.untilIt(({ time_us }) => time_us >= wanted, 'the last step on the page');
  }

  /** The picture as it is drawn now from the front: { width, height, rgba }, from the top. */
  async picture(hair = true) {
    const { width, height, text } = await this.page.evaluate((withHair) => {
      const { stage, hair: shown } = viewer;
      shown.hair.visible = withHair;
      shown.light.dirty = true;
      stage.draw();
      shown.hair.visible = true;
      const gl = stage.renderer.getContext(), { drawingBufferWidth: width, drawingBufferHeight: height } = gl, bytes = new Uint8Array(4 * width * height);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      return { width, height, text: Array.from(bytes, (byte) => String.fromCharCode(byte)).join('') };
    }, hair);
    const upsideDown = Buffer.from(text, 'latin1'), rgba = Buffer.alloc(upsideDown.length);
    for (let y = 0; y < height; y++) {
      upsideDown.copy(rgba, 4 * width * y, 4 * width * (height - 1 - y), 4 * width * (height - y));
    }
    return { width, height, rgba };
  }

  /** Drops a file on the page. */
  async drop(name, bytes) {
    await this.page.evaluate(({ name: file, data }) => {
      const transfer = new DataTransfer();
      transfer.items.add(new File([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], file));
      document.getElementById('stage').dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
    }, { name, data: Buffer.from(bytes).toString('base64') });
  }

  text(id) {
    return this.page.evaluate((name) => document.getElementById(name).textContent, id);
  }
}

/** Number of pixels for which `is` holds of (r, g, b, a, x, y). */
export function countPixels({ width, rgba }, is) {
  let count = 0;
  for (let i = 0; i < rgba.length; i += 4) {
    count += is(rgba[i], rgba[i + 1], rgba[i + 2], rgba[i + 3], (i / 4) % width, Math.floor(i / 4 / width)) ? 1 : 0;
  }
  return count;
}

/** Number of pixels that differ clearly. */
export function countDifferent(a, b) {
  let count = 0;
  for (let i = 0; i < a.rgba.length; i += 4) {
    count += Math.abs(a.rgba[i] - b.rgba[i]) + Math.abs(a.rgba[i + 1] - b.rgba[i + 1]) + Math.abs(a.rgba[i + 2] - b.rgba[i + 2]) > 60 ? 1 : 0;
  }
  return count;
}

