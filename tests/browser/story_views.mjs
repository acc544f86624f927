/** What holds in every view, whichever views there are: they are read from the navigation. */
import { walk } from './keyboard.mjs';
import { look } from './look.mjs';
import { Person } from './person.mjs';
import { order } from './starter.mjs';

const WITHIN_MS = 3000;
/** From the keys to the order: what half of the views take. */
const ASKED_MS = 1000;

/** An admin, who is shown every view there is. */
async function admin(browser, settings, people) {
  const person = await Person.arrive(browser, settings, 'admin');
  people.push(person);
  await person.enter();
  return person;
}

/** Calls `what` in each listed view, and in one (or `most`) of each kind that these lead to. */
export async function inEachView(person, what, { most = 1 } = {}) {
  const todo = [...(await person.listed())];
  const kinds = await person.kinds();
  const counts = new Map();
  for (const hash of todo) {
    await person.go(hash);
    for (const link of await person.details()) {
      const kind = link.split('/')[1];
      const count = counts.get(kind) ?? 0;
      if (count >= most || todo.includes(link)) continue;
      todo.push(link);
      counts.set(kind, count + 1);
    }
    await what(hash, hash.split('/').length > 2 ? `${hash.split('/')[1]}-one` : hash.split('/')[1]);
  }
  for (const kind of kinds) if (!todo.some((hash) => hash.startsWith(`#/${kind}/`))) person.faults.push(`none of ${kind} was visited, only ${todo.join(' ')}`);
  return todo;
}

export async function everyView(browser, settings, people) {
  const person = await admin(browser, settings, people);
  const views = await inEachView(person, (_, name) => look(person, name));
  return views.join(' ');
}

/** French words are longer, and nobody who writes the page reads them by chance. */
export async function everyViewInFrench(browser, settings, people) {
  const person = await admin(browser, settings, people);
  await person.page.evaluate(() => localStorage.setItem('trb.language', 'fr'));
  await person.page.reload();
  await navigationIsOneLine(person);
  const views = await inEachView(person, (_, name) => look(person, `${name}-fr`, { short: true }));
  const lang = await person.page.evaluate(() => document.documentElement.lang);
  if (lang !== 'fr') person.faults.push(`the document says that its language is "${lang}"`);
  return `${views.length} views`;
}

async function navigationIsOneLine({ page, faults }) {
  await page.waitForSelector('header nav');
  for (const width of [1280, 1366, 1440, 1536, 1920]) {
    await page.setViewportSize({ width, height: 800 });
    const tops = await page.$$eval('header nav a', (links) => new Set(links.map((link) => link.offsetTop)).size);
    if (tops > 1) faults.push(`at ${width} px the navigation has ${tops} lines`);
  }
}

export async function keyboardAlone(browser, settings, people) {
  const person = await admin(browser, settings, people);
  let controls = 0;
  await inEachView(person, async () => (controls += await walk(person)));
  return `${controls} controls`;
}

export async function stopsAll(browser, settings, people) {
  const person = await admin(browser, settings, people);
  const took = [];
  await inEachView(person, async (hash) => {
    const start = Date.now();
    const asked = person.page.waitForRequest((one) => one.method() === 'POST' && one.url().endsWith('/api/v1/stop'), { timeout: 15000 });
    await person.page.keyboard.press('Shift+Escape');
    await asked.catch(() => person.faults.push(`Shift+Esc does nothing in ${hash}`));
    took.push(Date.now() - start);
  });
  await person.page.waitForSelector('text=/Stopped: (\\d+) of \\1 have confirmed/');
  await person.go('#/hall');
  await person.page.waitForSelector('li:has-text("stopped")');
  await order('release');
  await person.page.waitForSelector('.counts li:has-text("stopped")', { state: 'detached' });
  await person.page.waitForSelector('[role=alert] :text-matches("The stop of .* is over: all [0-9]+ robots are released")');
  await look(person, 'stop-over', { short: true });
  took.sort((a, b) => a - b);
  const median = took[Math.floor(took.length / 2)];
  if (median > ASKED_MS) person.faults.push(`it is asked for only after ${median} ms (median)`);
  return `asked after ${median} ms (median), at most ${took.at(-1)} ms`;
}

export async function sourcesSilent(browser, settings, people) {
  const person = await admin(browser, settings, people);
  const { page } = person;
  person.expected.push(/Failed to load resource/); // the archive is the scheduler's, too
  const said = page.locator('[role=alert]:has-text("a new alarm would not be shown")');
  await order('hold_tables');
  await said.waitFor({ timeout: 60000 });
  await person.go('#/alerts');
  await page.waitForSelector('.count:has-text("not known which alerts")');
  if (await page.$('text="There was no alert."')) person.faults.push('it says that there was no alert');
  await look(person, 'silent-alerts', { short: true });
  await person.go('#/runs');
  await page.waitForSelector('[role=status]:has-text("not known what is under way")', { timeout: 60000 });
  if (await page.$('text="No run is under way."')) person.faults.push('it says that no run is under way');
  await look(person, 'silent-runs', { short: true });
  await order('let_tables_go');
  await said.waitFor({ state: 'detached', timeout: 60000 });
  await page.waitForSelector('[role=status]:has-text("not known what is under way")', { state: 'detached', timeout: 60000 });
  await person.go('#/alerts');
  await page.waitForSelector('.count:has-text("Open:")');
  return '';
}

export async function connectionLost(browser, settings, people) {
  const person = await admin(browser, settings, people);
  await person.go('#/hall');
  person.expected.push(/Failed to load resource|WebSocket connection to/);
  for (let tries = 1; ; ++tries) {
    const { lost, back, aged } = await loses(person);
    const told = `told after ${lost} ms ("${aged.trim()}"), back ${back} ms after the gateway`;
    if (Math.max(lost, back) <= WITHIN_MS) return told;
    if (tries === 3) throw new Error(`it takes over ${WITHIN_MS} ms: ${told}`);
  }
}

/** How long it takes until the page tells the loss, and until it is back. */
async function loses({ page }) {
  await order('kill_gateway');
  const killed = Date.now();
  await page.waitForSelector('[role=alert]:has-text("Connection lost")', { timeout: 60000 });
  await page.waitForSelector('main.stale');
  const lost = Date.now() - killed;
  await page.waitForTimeout(2500);
  const aged = await page.textContent('.lost:has-text("old")');
  const ready = await order('revive_gateway');
  await page.waitForSelector('.connection:not(.lost)', { state: 'attached', timeout: 60000 });
  await page.waitForSelector('main:not(.stale)');
  const back = Math.max(0, Math.round(Date.now() - ready));
  await page.waitForSelector('main table tbody tr:nth-child(9)', { timeout: 15000 }); // all robots are shown again
  return { lost, back, aged };
}
