/** A robot is driven by hand: keys move it, letting go stops it, and it passes from one person to another. */
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { Person } from './person.mjs';
import { press } from './press.mjs';
import { order } from './starter.mjs';

const ROBOT = 'pioneer1';
const OTHER = 'ridgeback';
const DRIVE_MS = 15000;
/** From an event in the page until the robot itself has stood. */
const STANDS_MS = 500;
/** Until the view shows where it stands. */
const SHOWN_MS = 1500;
/** What the machine may add to it: the browser, the starter and a fleet share its cores. */
const MACHINE_MS = 500;
/** Why a drive has ended by itself, as it must: a process on the way was not let run for half a second. By the page, the gateway, the robot's node. */
const SILENT = /(for|within) 500 ms|does not answer|has ended the drive|deadline had passed|not delivered|No answer came from the robot/;
/** What a machine that has much to do may make fail, until it is a fault. */
const TRIES = 3;
const WANTED = `the drive ended ${TRIES} times for want of a word within 500 ms`;

export async function drives(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  const admin = await Person.arrive(browser, settings, 'admin');
  people.push(olga, admin);
  for (const one of [olga, admin]) {
    await one.enter();
    await one.go(`#/control/${ROBOT}`);
    await place(one.page);
  }
  const [winner, loser] = await bothBegin(olga, admin);
  const took = {};
  took.key = await driveAnd(winner, 'the key is let go', () => winner.page.keyboard.up('w'), { pictured: 'control-driving' });
  await showsPlace(winner);
  took.blur = await driveAnd(winner, 'the window loses the focus', () => winner.page.evaluate(() => dispatchEvent(new Event('blur'))), { undo: () => winner.page.keyboard.up('w') });
  await handOver(winner, loser);
  took.stop = await driveAnd(loser, 'Shift+Esc', () => loser.page.keyboard.press('Shift+Escape'), { undo: () => stopped(loser) });
  await begin(winner);
  await isTold(loser, winner);
  took.page = await driveAnd(winner, 'the page is closed', () => winner.page.close());
  await loser.page.getByText('Nobody drives it').waitFor();
  return Object.entries(took).map(([cause, ms]) => `${cause} ${ms} ms`).join(', ');
}

/** Back leads from the robot that is driven to another one: the drive ends, and no key moves what is not shown. */
export async function leavesDriven(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  const words = [];
  const ends = []; // of its drive, by the gateway, for another reason than that he let go
  olga.page.on('websocket', (socket) => {
    socket.on('framesent', ({ payload }) => words.push(JSON.parse(String(payload))));
    socket.on('framereceived', ({ payload }) => {
      const told = JSON.parse(String(payload)).drive;
      if (told?.robot === ROBOT && told.state === 'over' && told.error) ends.push(told);
    });
  });
  await olga.enter();
  await olga.go(`#/control/${OTHER}`);
  await olga.page.getByLabel('Robot', { exact: true }).selectOption(ROBOT);
  const end = await backLetsGo(olga, words, ends);
  await olga.page.keyboard.up('w');
  await olga.page.keyboard.press('w', { delay: 300 });
  await order('last_move', ROBOT);
  const later = words.slice(end + 1).filter((word) => word.drive !== undefined);
  if (later.length > 0) throw new Error(`speeds after it was let go: ${JSON.stringify(later)}`);
}

/** Which of the words let go. A drive that had ended by itself before Back is begun anew. */
async function backLetsGo(olga, words, ends) {
  const { page } = olga;
  const shown = (robot) => page.getByRole('button', { name: `Stop ${robot}` }).waitFor();
  for (let tries = 1; ; ++tries) {
    await shown(ROBOT);
    await begin(olga);
    const ended = ends.length;
    await drivesOffAtLast(olga);
    const before = words.length;
    await page.goBack();
    await shown(OTHER);
    await page.getByText('Nobody drives it').waitFor();
    const end = words.findIndex((word, at) => at >= before && word.let_go === ROBOT);
    if (end >= 0) return end;
    if (tries === TRIES || ends.length === ended) throw new Error(`${ROBOT} was not let go`);
    await page.keyboard.up('w');
    await page.goForward();
  }
}

/** Both press it at once: one drives, the other is told who does. */
async function bothBegin(...people) {
  for (let tries = 1; tries <= TRIES; ++tries) {
    await pressAtOnce(people);
    const winner = await Promise.any(people.map(async (one) => {
      await one.page.getByText(`You drive ${ROBOT}`).waitFor({ timeout: DRIVE_MS });
      return one;
    })).catch(() => undefined); // a drive that ended as soon as it had begun
    if (winner === undefined) continue;
    const loser = people.find((one) => one !== winner);
    await isTold(loser, winner);
    return [winner, loser];
  }
  throw new Error(`both pressed it, and nobody drives ${ROBOT}`);
}

/** Both are found before either is pressed: what was pressed later may be "Ask for it" by then. */
async function pressAtOnce(people) {
  const buttons = await Promise.all(people.map(({ page }) => beginButton(page).and(page.locator(':enabled')).elementHandle()));
  const at = Date.now() + 500;
  await Promise.all(buttons.map((one) => one.evaluate(async (button, when) => {
    await new Promise((done) => setTimeout(done, when - Date.now()));
    button.click();
  }, at)));
}

const beginButton = (page) => page.getByRole('button', { name: 'Begin to drive' });

/** Unless he drives already. A drive that ends at once, as on a machine that has much to do, is begun anew. */
async function begin({ page }) {
  const drives = page.getByText(`You drive ${ROBOT}`);
  const button = beginButton(page);
  for (let tries = 1; tries <= TRIES; ++tries) {
    await drives.or(button).first().waitFor();
    if (await drives.isVisible()) return;
    await press(button);
    await drives.or(silence(page)).first().waitFor({ timeout: DRIVE_MS });
    if (await drives.isVisible()) return;
  }
  throw new Error('three drives ended as soon as they had begun');
}

/** Who looks on is told who drives; a drive that has ended by itself meanwhile is begun anew. */
async function isTold(other, driver) {
  const said = other.page.getByText(`${driver.name} drives it`);
  for (let tries = 1; ; ++tries) {
    try {
      return await said.waitFor({ timeout: DRIVE_MS });
    } catch (late) {
      if (tries === TRIES) throw late;
      if (await wasSilent(driver.page)) await begin(driver);
    }
  }
}

/** Where the view says that the robot is, in metres. */
async function place(page) {
  const text = page.locator('dd').filter({ hasText: /^x .* m, y .* m$/ });
  await text.waitFor();
  const [, x, y] = /x (\S+) m, y (\S+) m/.exec((await text.textContent()).replaceAll('−', '-').replaceAll('\u00a0', ' '));
  return [Number(x), Number(y)];
}

/**
 * By key, until the view shows that it has moved; then `event`. How long the robot itself, asked by its own console, moved on.
 * The best of three tries. `undo`: of what the event leaves, so that one can drive again.
 */
async function driveAnd(person, what, event, { pictured = '', undo = async () => undefined } = {}) {
  const { page } = person;
  for (let tries = 1; ; ++tries) {
    await drivesOffAtLast(person);
    if (pictured) await picture(person, pictured);
    let happened = false;
    const ms = await movesOn(page, () => ((happened = true), event()));
    await (happened ? undo() : page.keyboard.up('w'));
    if (ms !== undefined && ms <= STANDS_MS + MACHINE_MS) return ms;
    if (tries === TRIES || page.isClosed()) {
      if (ms === undefined) throw new Error(WANTED);
      person.faults.push(`it moves on for ${ms} ms after ${what}`);
      return ms;
    }
    await begin(person);
  }
}

/** How long it moves on after the event. Undefined: its drive had ended by itself, and nothing was seen. */
async function movesOn(page, event) {
  if (!(await order('await_moving', ROBOT))) return undefined;
  await page.evaluate(() => {
    globalThis.heardAt = 0; // the browser may hear of it later than it was told to
    for (const kind of ['keyup', 'keydown', 'blur']) addEventListener(kind, () => (globalThis.heardAt ||= Date.now()), { capture: true });
  });
  const told = Date.now();
  await event();
  const closed = Date.now();
  const last = await order('last_move', ROBOT);
  const at = page.isClosed() ? closed : (await page.evaluate(() => globalThis.heardAt)) || told;
  return !page.isClosed() && (await wasSilent(page)) ? undefined : Math.max(0, Math.round(last - at));
}

const silence = (page) => page.locator('.why').filter({ hasText: SILENT }).first();
const wasSilent = (page) => silence(page).isVisible();

/** The view's place is where the robot itself says that it has come to stand. */
async function showsPlace(person) {
  for (let tries = 1; ; ++tries) {
    const ms = await placeShownAfter(person.page);
    if (ms <= SHOWN_MS + MACHINE_MS) return;
    if (tries === TRIES) return person.faults.push(`it is shown where it stands only after ${ms} ms`);
    await begin(person);
    await drivesOffAtLast(person);
    await person.page.keyboard.up('w');
    await order('last_move', ROBOT);
  }
}

async function placeShownAfter(page) {
  const [, [x, y]] = await order('where', ROBOT);
  const start = Date.now();
  for (;;) {
    const shown = await place(page);
    const ms = Date.now() - start;
    if (Math.hypot(x - shown[0], y - shown[1]) < 0.02) return ms;
    if (ms > DRIVE_MS) throw new Error(`it stands at ${x}, ${y}, and is shown at ${shown}`);
    await page.waitForTimeout(50);
  }
}

/** False: the browser was not let run for half a second, and so the drive ended, as it must. */
async function drivesOff(person) {
  const from = await place(person.page);
  await person.page.keyboard.down('w');
  return moved(person, from, 0.1);
}

/** A drive that has ended like that is begun anew. */
async function drivesOffAtLast(person) {
  for (let tries = 1; !(await drivesOff(person)); ++tries) {
    if (tries === TRIES) throw new Error(WANTED);
    await person.page.keyboard.up('w');
    await begin(person);
  }
}

async function moved({ page }, from, metres) {
  const end = Date.now() + DRIVE_MS;
  while (Date.now() < end) {
    await page.waitForTimeout(50); // it is sampled while it drives
    const [x, y] = await place(page);
    if (Math.hypot(x - from[0], y - from[1]) >= metres) return true;
    if (await wasSilent(page)) return false;
  }
  const said = await page.locator('main [role=status], main [role=alert]').allTextContents();
  throw new Error(`it has not moved by ${metres} m from ${from}: ${said.map((text) => text.trim()).join(' ')}`);
}

const isKeptFor = ({ page }) => page.getByText('It was handed over to you');

/** Until the driver is told of it; one whose drive has ended for want of a word begins anew, unless it is kept for who asked. */
async function asks(other, driver) {
  const told = driver.page.getByText(`${other.name} asks for this robot`);
  for (let tries = 1; !(await isKeptFor(other).isVisible()); ++tries) {
    if (await wasSilent(driver.page)) await begin(driver);
    try {
      if (!(await told.isVisible())) await press(other.page.getByRole('button', { name: 'Ask for it' }), { timeout: 5000 });
      return await told.waitFor({ timeout: 5000 });
    } catch (late) {
      if (tries === TRIES) throw late;
    }
  }
}

/** Somebody asks, the driver hands over, the other one begins. */
async function handOver(driver, other) {
  const handed = driver.page.getByRole('button', { name: `Hand over to ${other.name}` });
  for (let tries = 1; ; ++tries) {
    await asks(other, driver);
    try {
      if (!(await isKeptFor(other).isVisible())) await press(handed, { timeout: 5000 });
      await isKeptFor(other).waitFor({ timeout: 5000 });
      break;
    } catch (late) {
      if (tries === TRIES) throw late;
    }
  }
  await begin(other);
  await isTold(driver, other);
}

/** The drive is over, the page says so, and no key moves a robot that is stopped. */
async function stopped({ page }) {
  await page.keyboard.up('w');
  await page.getByText(/Stopped: (\d+) of \1 have confirmed/).waitFor();
  await page.getByText('Nobody drives it').waitFor();
  await page.locator('.head').getByText('stopped').first().waitFor();
  await order('release');
  await page.locator('.head').getByText('stopped').first().waitFor({ state: 'detached' });
}

async function picture({ page, settings }, name) {
  if (!settings.pictures) return;
  mkdirSync(settings.pictures, { recursive: true });
  await page.screenshot({ path: join(settings.pictures, `${name}.png`), caret: 'initial' });
}
