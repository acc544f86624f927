/** The page's figures in Chromium: node page_bench.mjs SETTINGS; page_bench.py starts it with a real gateway. `robots`: its map. */
import { Person, startBrowser } from '../../browser/person.mjs';

const settings = JSON.parse(process.argv[2]);
const browser = await startBrowser();
const figures = settings.robots === undefined ? { first: await firstView() } : { map: await mapFrames() };
await browser.close();
console.log(JSON.stringify(figures));

/** Opened anew each time by somebody who is signed in: all that is sent until the hall is shown, and how long that takes. */
async function firstView() {
  const admin = await Person.arrive(browser, settings, 'admin');
  await admin.enter();
  const storageState = await admin.context.storageState();
  const rounds = [];
  for (let i = 0; i < settings.rounds; i++) rounds.push(await openOnce(storageState));
  await admin.context.close();
  return rounds;
}

async function openOnce(storageState) {
  const context = await browser.newContext({ ignoreHTTPSErrors: true, viewport: { width: 1280, height: 800 }, storageState });
  const page = await context.newPage();
  const network = await context.newCDPSession(page);
  const sizes = new Map();
  network.on('Network.loadingFinished', ({ requestId, encodedDataLength }) => sizes.set(requestId, encodedDataLength));
  await network.send('Network.enable');
  await page.goto(settings.url, { waitUntil: 'commit' });
  await page.waitForSelector('main h1');
  await page.waitForSelector('.connection:not(.lost)', { state: 'attached' });
  await page.waitForSelector('main table tbody');
  const ms = await page.evaluate(() => performance.now());
  await page.waitForLoadState('networkidle');
  await context.close();
  return { ms, bytes: [...sizes.values()].reduce((sum, one) => sum + one, 0) };
}

/** The hall with all robots: how often the map is drawn while nobody touches it, and while somebody pans without a pause. */
async function mapFrames() {
  const admin = await Person.arrive(browser, settings, 'admin');
  await admin.enter();
  const { page } = admin;
  const shown = (count) => document.querySelector('.surface')?.getAttribute('aria-label')?.includes(String(count));
  await page.waitForFunction(shown, settings.robots, { timeout: 120_000 });
  const rounds = [];
  for (let i = 0; i < settings.rounds; i++) {
    const still = await page.evaluate(countFrames, { seconds: settings.seconds, pans: false });
    const panned = await page.evaluate(countFrames, { seconds: settings.seconds, pans: true });
    rounds.push({ still, panned });
  }
  await admin.context.close();
  return rounds;
}

/** Runs in the page. A drawing begins with clearRect; `screen`: the frames that the browser itself gives. */
async function countFrames({ seconds, pans }) {
  const surface = document.querySelector('.surface');
  const canvas = CanvasRenderingContext2D.prototype;
  const clear = canvas.clearRect;
  let [drawn, screen] = [0, 0];
  canvas.clearRect = function (...box) {
    ++drawn;
    clear.apply(this, box);
  };
  const pan = () => {
    const key = Math.floor(screen / 10) % 2 === 0 ? 'ArrowLeft' : 'ArrowRight';
    surface.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }));
  };
  const begin = performance.now();
  await new Promise((done) => {
    const step = () => {
      ++screen;
      if (pans) setTimeout(pan); // between two frames, as a hand's events come
      if (performance.now() - begin < seconds * 1000) requestAnimationFrame(step);
      else done();
    };
    requestAnimationFrame(step);
  });
  canvas.clearRect = clear;
  const took = (performance.now() - begin) / 1000;
  return { drawn: drawn / took, screen: screen / took };
}
