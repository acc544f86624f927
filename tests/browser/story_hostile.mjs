/** Texts that robots, sensors, scenarios, users and messages choose are shown as text, whatever stands in them. */
import { Person } from './person.mjs';
import { inEachView } from './story_views.mjs';
import { order } from './starter.mjs';

// 64 characters at most, as a scenario's name has. The policy of the page is left out here: it would hide what the page lets through.
const TEXT = '"><img src=x onerror=hit(1)><svg onload=hit(2)>{{hit(3)}}';
/** Texts of people, robots and devices in what the gateway sends; the other ones are words of its own. */
const FREE = new Set(['text', 'detail', 'reason', 'note', 'maker', 'model', 'version', 'via', 'address', 'person', 'by', 'what', 'cure', 'why', 'cause',
  'waits_for', 'description', 'unit', 'device', 'identity', 'about', 'who', 'outcome', 'subtype', 'hint', 'title', 'condition', 'data', 'capability',
  'paused_by', 'submitter', 'moved_from', 'licence']);

export async function hostileTexts(browser, settings, people) {
  const told = await order('hostile', TEXT);
  const chosen = await visit(browser, settings, people, async () => undefined, ['#/alerts', '#/robots']);
  for (const kind of ['scenarios', 'robots', 'alerts', 'audit', 'messages']) {
    if (!chosen.views.some((view) => view.startsWith(`#/${kind}`))) throw new Error(`no such text was shown in ${kind}, but in ${chosen.views}`);
  }
  const all = await visit(browser, settings, people, everywhere);
  return `${told} said it, shown as text in ${chosen.views.length} views; put into everything that the gateway sends, in ${all.views.length}`;
}

/** `slow`: views that are told of such a text by a table that the gateway reads each second or two. */
async function visit(browser, settings, people, prepare, slow = []) {
  const person = await Person.arrive(browser, settings, 'admin', { bypassCSP: true });
  people.push(person);
  const { page } = person;
  page.on('dialog', (dialog) => {
    person.faults.push(`a text has opened a dialogue: ${dialog.message()}`);
    void dialog.dismiss();
  });
  await page.addInitScript(() => {
    globalThis.hits = [];
    globalThis.hit = (what) => globalThis.hits.push(what);
  });
  await prepare(page);
  await page.goto(settings.url);
  await person.enter();
  const views = [];
  await inEachView(person, async (hash) => {
    if (hash === '#/messages') await awaitMessage(page);
    if (slow.includes(hash)) await page.locator('main', { hasText: '<img src=x' }).waitFor({ timeout: 15000 }).catch(() => undefined);
    await openAll(person);
    if ((await page.innerText('body')).includes('<img src=x')) views.push(hash);
    await innocent(person, hash);
  }, { most: 3 });
  for (const path of ['robots', 'runs', 'alerts', 'sensors/cloud', 'scenarios', TEXT]) {
    await page.evaluate((to) => (location.hash = to), `#/${path}/${encodeURIComponent(TEXT)}`);
    person.expected.push(/status of 4\d\d/);
    await person.drawn(); // of what nobody has it may say for ever that it is being loaded
    await innocent(person, path);
  }
  await trapWorks(page);
  return { views };
}

/** One with such a text, which passes while this is shown: said again, for the gateway may have read it before that this is shown. */
async function awaitMessage(page) {
  await page.getByLabel('Filter').fill('say');
  for (let tries = 1; ; ++tries) {
    await order('say', TEXT);
    try {
      return await page.waitForSelector('main tbody button:has-text("say")', { timeout: 10000 });
    } catch (late) {
      if (tries === 3) throw late;
    }
  }
}

/** What is folded, and what a press shows. */
async function openAll(person) {
  const { page } = person;
  await page.$$eval('main details', (all) => all.forEach((one) => (one.open = true)));
  for (const one of await page.$$('main tbody button[aria-pressed=false]:enabled, main .graph button')) await one.evaluate((button) => button.click());
  await person.settled();
}

async function innocent(person, where) {
  const found = await person.page.evaluate(() => [
    ...globalThis.hits.map((one) => `script ran: ${one}`),
    ...[...document.querySelectorAll('[onerror], [onload], img[src=x], main script')].map((one) => one.outerHTML.slice(0, 160)),
  ]);
  for (const one of found) person.faults.push(`in ${where}: ${one}`);
}

/** A page that took the text for HTML would be found out. */
async function trapWorks(page) {
  await page.evaluate((text) => document.querySelector('main').insertAdjacentHTML('beforeend', text), TEXT.slice(2));
  await page.waitForFunction(() => globalThis.hits.length > 0);
}

/** Every such text of every answer and frame ends with it. */
async function everywhere(page) {
  await page.route('**/api/v1/**', async (route) => {
    const answer = await route.fetch();
    const type = answer.headers()['content-type'] ?? '';
    if (!type.includes('json')) return route.fulfill({ response: answer });
    return route.fulfill({ response: answer, json: spoiled(await answer.json()) });
  });
  await page.routeWebSocket('**/api/v1/live', (socket) => {
    const server = socket.connectToServer();
    server.onMessage((text) => socket.send(JSON.stringify(spoiled(JSON.parse(text)))));
  });
}

function spoiled(value, key = '') {
  if (typeof value === 'string') return FREE.has(key) ? value + TEXT : value;
  if (Array.isArray(value)) return value.map((one) => spoiled(one, key));
  if (typeof value !== 'object' || value === null) return value;
  return Object.fromEntries(Object.entries(value).map(([name, one]) => [name, spoiled(one, name)]));
}
