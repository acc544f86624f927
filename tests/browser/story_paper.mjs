/** Section 6.1 of the paper, as its operator lives it in the page, from the drawing of the scenario to the audit. */
import { walk } from './keyboard.mjs';
import { look } from './look.mjs';
import { Person } from './person.mjs';
import { press } from './press.mjs';
import { order } from './starter.mjs';
import { draw } from './story_draw.mjs';

const RUN_MS = 60000;
const SENSOR_MS = 60000;

export async function paper(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  await olga.enter();

  await draw(olga, JSON.parse(await order('scenario')));
  await preflight(olga);
  await save(olga);
  await triesWithSensor(olga);
  const robot = await order('fail_robot');
  const run = await start(olga);
  await watch(olga, robot);
  await unplug(olga);
  const decided = await decide(olga, robot);
  const state = await order('await_run', run);
  if (state !== 'FINISHED') throw new Error(`the run is ${state}`);
  await seeEnd(olga, run);
  await audited(browser, settings, people);
  return decided;
}

/** A robot that is silent for 3 s is told as such, and is asked again. */
async function preflight(olga) {
  const { page } = olga;
  const ready = page.locator('h2', { hasText: 'A run could begin now' });
  for (let tries = 1; tries <= 3 && !(await ready.isVisible()); ++tries) {
    const answer = page.waitForResponse((one) => one.url().endsWith('/scenarios/preflight'), { timeout: SENSOR_MS });
    await press(page.getByRole('button', { name: 'Ask the robots' }));
    await answer;
    await page.locator('h2', { hasText: /A run could (not )?begin now/ }).waitFor();
    await olga.drawn();
  }
  await ready.waitFor({ timeout: 5000 });
  await look(olga, 'editor-preflight');
}

async function save(olga) {
  const { page } = olga;
  await press(page.getByRole('button', { name: 'Save', exact: true }));
  await page.waitForFunction(() => !location.hash.endsWith('/new'));
}

/** Its condition waits for a sensor: what that tells is said first; in a wrong unit it is refused, beside the form. */
async function triesWithSensor(olga) {
  const { page } = olga;
  await page.waitForSelector('main :text("can run")');
  await press(page.getByRole('button', { name: 'Try in Plan' }));
  olga.expected.push(/status of 422 .*\/api\/v1\/simulations$/);
  const sensor = page.getByRole('group', { name: 'Sensor 1' });
  await sensor.getByLabel('Value', { exact: true }).fill('15');
  await sensor.getByLabel('Unit').fill('K');
  await press(page.getByRole('button', { name: 'Simulate', exact: true }));
  await page.waitForSelector('main [role=alert]:has-text("whose unit is")', { timeout: SENSOR_MS });
  await look(olga, 'plan-refused', { short: true });
  await sensor.getByLabel('Unit').fill('degC');
  await page.waitForSelector('main [role=alert]', { state: 'detached' });
  await walk(olga);
  await press(page.getByRole('button', { name: 'Simulate', exact: true }));
  await page.waitForSelector('h2:has-text("What each task waited for")', { timeout: RUN_MS });
  const names = await page.locator('.chart .names span').allInnerTexts();
  const sides = ['pick_left', 'pick_right'].map((task) => names.some((name) => name.includes(task)));
  if (!sides[0] || sides[1]) olga.faults.push(`at 15 degC it picks left, done were ${names}`);
  await press(page.getByRole('link', { name: 'Back to the scenario' }));
  await page.waitForFunction(() => location.hash.startsWith('#/scenarios/'));
}

async function start(olga) {
  const { page } = olga;
  const button = page.getByRole('button', { name: '▶ Run' });
  await page.waitForSelector('main :text("can run")');
  await press(button);
  await page.waitForFunction(() => location.hash.startsWith('#/runs/'));
  return page.evaluate(() => location.hash.split('/')[2]);
}

/** The run goes on before his eyes, until a robot stands. */
async function watch(olga, robot) {
  const { page } = olga;
  const box = (id, state) => page.waitForSelector(`button:has(strong:text-is("${id}")):has-text("${state}")`, { timeout: RUN_MS });
  await box('fetch_box', 'finished');
  await box('put_box_down', 'finished');
  await box('go_to_ur3', 'failed');
  await page.waitForSelector(`a.alarm:has-text("${robot}")`, { timeout: RUN_MS });
  await page.waitForSelector(`main a:has-text("${robot}")`);
  await look(olga, 'run-fault');
  await olga.go('#/hall');
  await look(olga, 'hall-fault');
}

/** The thermometer of the conveyor is pulled out, and plugged in again. */
async function unplug(olga) {
  const { page } = olga;
  await olga.go('#/sensors');
  await page.waitForSelector('main tr:has-text("temperature"):has-text("ok")', { timeout: SENSOR_MS });
  await order('unplug');
  await page.waitForSelector('main tr:has-text("temperature"):has-text("ok")', { state: 'detached', timeout: SENSOR_MS });
  await look(olga, 'sensors-unplugged');
  await order('plug');
  await page.waitForSelector('main tr:has-text("temperature"):has-text("ok")', { timeout: SENSOR_MS });
}

/** The alarm leads to the alert; all by keyboard. */
async function decide(olga, robot) {
  const { page } = olga;
  await olga.tabTo('a.alarm');
  await page.keyboard.press('Enter');
  await page.waitForSelector(`h1:has-text("${robot}")`);
  await page.waitForSelector('input[type=range]');
  await look(olga, 'alert-open');
  await judge(olga);
  const first = () => page.textContent('ol > li:first-child strong');
  const best = await first();
  const other = await weighUntilAnotherIsFirst(olga, first, best);
  await olga.tabTo('ol > li:first-child button');
  await page.keyboard.press('Enter');
  await page.waitForSelector('dialog[open] form');
  await look(olga, 'alert-decide');
  await olga.tabTo('dialog[open] button[type=submit]');
  await page.keyboard.press('Enter');
  await page.waitForSelector('main :text("by olga")', { timeout: RUN_MS });
  return `${best} was best, by other weights ${other}; decided by olga`;
}

/** By pairs, and back to the sliders. */
async function judge(olga) {
  const { page } = olga;
  await page.getByLabel('Judgments by pairs').check();
  await page.waitForSelector('main table select');
  await page.waitForSelector('main :text("Consistency ratio")');
  await look(olga, 'alert-pairs');
  await press(page.getByRole('button', { name: 'As in force' }));
  await page.waitForSelector('input[type=range]');
}

/** Moves the sliders by keys. With one at its end, its criterion alone counts. */
async function weighUntilAnotherIsFirst(olga, first, best) {
  const { page } = olga;
  const sliders = page.locator('input[type=range]');
  for (let i = 0; i < (await sliders.count()); i++) {
    await sliders.nth(i).press('End');
    const changed = await page.waitForFunction(
      (was) => document.querySelector('ol > li:first-child strong')?.textContent !== was, best, { timeout: 10000 }).catch(() => null);
    if (changed) return first();
  }
  throw new Error(`${best} stays first, whatever counts`);
}

async function seeEnd(olga, run) {
  await olga.go(`#/runs/${run}`);
  await olga.page.waitForSelector('main :text("finished")');
  await olga.page.waitForSelector('main section:has(h2:text-is("Decisions")):has-text("olga")');
}

async function audited(browser, settings, people) {
  const admin = await Person.arrive(browser, settings, 'admin');
  people.push(admin);
  await admin.enter();
  await admin.go('#/audit');
  await admin.page.waitForSelector('main tr:has-text("olga"):has-text("decision")');
}
