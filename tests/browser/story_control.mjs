/** A robot is driven by hand: keys move it, letting go stops it, and it passes from one person to another. */
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { Person } from './person.mjs';
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
  took.key = await driveAnd(winner, 'the key is let go', () => winner.page.keyboard.up('w'), 'control-driving');
  await showsPlace(winner);
  took.blur = await driveAnd(winner, 'the window loses the focus', () => winner.page.evaluate(() => dispatchEvent(new Event('blur'))));
  await winner.page.keyboard.up('w');
  await handOver(winner, loser);
  took.stop = await driveAnd(loser, 'Shift+Esc', () => loser.page.keyboard.press('Shift+Escape'));
  await loser.page.keyboard.up('w');
  await stopped(loser);
  await begin(winner);
  await loser.page.getByText(`${winner.name} drives it`).waitFor();
  took.page = await driveAnd(winner, 'the page is closed', () => winner.page.close());
  await loser.page.getByText('Nobody drives it').waitFor();
  return Object.entries(took).map(([cause, ms]) => `${cause} ${ms} ms`).join(', ');
}

/** Back leads from the robot that is driven to another one: the drive ends, and no key moves what is not shown. */
export async function leavesDriven(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  const words = [];
  olga.page.on('websocket', (socket) => socket.on('framesent', ({ payload }) => words.push(JSON.parse(String(payload)))));
  await olga.enter();
  await olga.go(`#/control/${OTHER}`);
  await olga.page.getByLabel('Robot', { exact: true }).selectOption(ROBOT);
  await olga.page.getByRole('button', { name: 'Begin to drive' }).and(olga.page.locator(':enabled')).waitFor();
  await begin(olga);
  await drivesOffAtLast(olga);
  await olga.page.goBack();
  await olga.page.getByRole('button', { name: `Stop ${OTHER}` }).waitFor();
  await olga.page.getByText('Nobody drives it').waitFor();
  const end = words.findIndex((word) => word.let_go === ROBOT);
  if (end < 0) throw new Error(`${ROBOT} was not let go`);
  await olga.page.keyboard.up('w');
  await olga.page.keyboard.press('w', { delay: 300 });
  await order('last_move', ROBOT);
  const later = words.slice(end + 1).filter((word) => word.drive !== undefined);
  if (later.length > 0) throw new Error(`speeds after it was let go: ${JSON.stringify(later)}`);
}

/** Both press it at once: one drives, the other is told who does. */
async function bothBegin(...people) {
  const at = Date.now() + 500;
  await Promise.all(people.map((one) => one.page.getByRole('button', { name: 'Begin to drive' }).evaluate(async (button, when) => {
    await new Promise((done) => setTimeout(done, when - Date.now()));
    button.click();
  }, at)));
  const winner = await Promise.any(people.map(async (one) => {
    await one.page.getByText(`You drive ${ROBOT}`).waitFor({ timeout: DRIVE_MS });
    return one;
  }));
  const loser = people.find((one) => one !== winner);
  await loser.page.getByText(`${winner.name} drives it`).waitFor();
  return [winner, loser];
}

async function begin(person) {
  await person.page.getByRole('button', { name: 'Begin to drive' }).press('Enter');
  await person.page.getByText(`You drive ${ROBOT}`).waitFor({ timeout: DRIVE_MS });
}

/** Where the view says that the robot is, in metres. */
async function place(page) {
  const text = page.locator('dd').filter({ hasText: /^x .* m, y .* m$/ });
  await text.waitFor();
  const [, x, y] = /x (\S+) m, y (\S+) m/.exec((await text.textContent()).replaceAll('−', '-').replaceAll('\u00a0', ' '));
  return [Number(x), Number(y)];
}

/** By key, until the view shows that it has moved; then `event`. How long the robot itself, asked by its own console, moved on. */
async function driveAnd(person, what, event, pictured = '') {
  const { page } = person;
  for (let tries = 1; ; ++tries) {
    if (await drivesOff(person)) {
      if (pictured) await picture(person, pictured);
      const ms = await movesOn(page, event);
      if (ms > STANDS_MS + MACHINE_MS) person.faults.push(`it moves on for ${ms} ms after ${what}`);
      if (ms !== undefined) return ms;
    }
    if (tries === 3) throw new Error('the drive ended three times for want of a word within 500 ms');
    await page.keyboard.up('w');
    await begin(person);
  }
}

/** How long it moves on after the event. Undefined: its drive had ended by itself, and nothing was seen. */
async function movesOn(page, event) {
  if (!(await order('await_moving', ROBOT))) return undefined;
  const at = Date.now();
  await event();
  const ms = Math.max(0, Math.round((await order('last_move', ROBOT)) - at));
  return !page.isClosed() && (await wasSilent(page)) ? undefined : ms;
}

/** By the gateway's word, or by the robot's node's. */
const wasSilent = (page) => page.getByText(/(no word|nothing more was heard) for 500 ms/).isVisible();

/** The view's place is where the robot itself says that it has come to stand. */
async function showsPlace({ page, faults }) {
  const [, [x, y]] = await order('where', ROBOT);
  const start = Date.now();
  for (;;) {
    const shown = await place(page);
    const ms = Date.now() - start;
    if (Math.hypot(x - shown[0], y - shown[1]) < 0.02) {
      if (ms > SHOWN_MS + MACHINE_MS) faults.push(`it is shown where it stands only after ${ms} ms`);
      return;
    }
    if (ms > DRIVE_MS) return faults.push(`it stands at ${x}, ${y}, and is shown at ${shown}`);
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
    if (tries === 3) throw new Error('the drive ended three times for want of a word within 500 ms');
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

/** Until the driver is told of it; one whose drive has ended for want of a word begins anew. */
async function asks(other, driver) {
  const told = driver.page.getByText(`${other.name} asks for this robot`);
  for (let tries = 1; ; ++tries) {
    if (await wasSilent(driver.page)) await begin(driver);
    try {
      if (!(await told.isVisible())) await other.page.getByRole('button', { name: 'Ask for it' }).press('Enter', { timeout: 5000 });
      return await told.waitFor({ timeout: 5000 });
    } catch (late) {
      if (tries === 3) throw late;
    }
  }
}

/** Somebody asks, the driver hands over, the other one begins. */
async function handOver(driver, other) {
  await asks(other, driver);
  await driver.page.getByRole('button', { name: `Hand over to ${other.name}` }).press('Enter');
  await other.page.getByText('It was handed over to you').waitFor();
  await begin(other);
  await driver.page.getByText(`${other.name} drives it`).waitFor();
}

/** The drive is over, the page says so, and no key moves a robot that is stopped. */
async function stopped({ page }) {
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
