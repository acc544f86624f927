/** A scenario from the editor is tried in Plan, changed, tried again, with a fault, compared, watched as a film, and run. */
import { walk } from './keyboard.mjs';
import { look } from './look.mjs';
import { Person } from './person.mjs';
import { press } from './press.mjs';
import { order } from './starter.mjs';
import { drawAll, drawTask, openEditor } from './story_draw.mjs';

const DONE = { timeout: 60_000 };
const SCENARIO = {
  name: 'to the picking place', description: 'The arm waits for the belt',
  tasks: [
    { id: 'run_belt', robot: 'conveyor', skill: 'run' },
    { id: 'put_down', robot: 'ur3', skill: 'grasp_and_put_down', data: { side: 'left' }, after: ['run_belt'] },
  ],
};
const MORE = { id: 'pick_it', robot: 'ur3', skill: 'pick', data: { side: 'left' }, after: ['put_down'] };

export async function triesAScenario(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  await olga.enter();
  const { page } = olga;
  await openEditor(olga);
  await drawAll(olga, SCENARIO);

  const first = await tried(olga, 2);
  await look(olga, 'plan-scenario');
  await watch(olga);
  await back(olga, 2);
  await drawTask(olga, MORE, 2);
  const second = await tried(olga, 3);
  if (first === second) throw new Error('the second try is the first one');
  await again(olga);
  await atOnce(olga);
  await compare(olga, ['plan-scenario-fault-compare', 2, 1]);
  await compare(olga, ['plan-scenario-compare', 3, 2]);
  await press(page.locator('main li a').nth(1));
  await page.waitForSelector('h2:has-text("What each task waited for")', DONE);
  await back(olga, 3);
  return run(olga);
}

/** Not saved: what is drawn is tried, and the result names what was waited for. */
async function tried(olga, count) {
  const { page } = olga;
  await page.waitForSelector('main header :text("can run")');
  await press(page.getByRole('button', { name: 'Try in Plan' }));
  await page.waitForFunction(() => location.hash.startsWith('#/plan/'));
  await page.waitForSelector('h2:has-text("What each task waited for")', DONE);
  await page.waitForSelector(`h1:has-text("${SCENARIO.name}")`);
  const waits = page.locator('[role=region][aria-label="What each task waited for"] tbody tr');
  const rows = (await waits.allInnerTexts()).map((text) => text.replaceAll(/\s+/g, ' '));
  if (rows.length !== count) throw new Error(`${count} tasks were drawn, told are ${rows}`);
  const held = rows.find((row) => row.startsWith('put_down'));
  if (!/run_belt .*◆ on it/.test(held ?? '')) olga.faults.push(`put_down waits for run_belt, told is ${held}`);
  const marked = await page.locator('.area .bar.path').count();
  if (marked !== count) olga.faults.push(`${marked} bars are marked as the critical path, not ${count}`);
  const names = await page.locator('.chart .names span').allInnerTexts();
  if (!names.every((name) => name.startsWith('◆'))) olga.faults.push(`a name on the critical path has no mark: ${names}`);
  return page.evaluate(() => location.hash);
}

async function back(olga, count) {
  const { page } = olga;
  await press(page.getByRole('link', { name: 'Back to the scenario' }));
  await page.waitForSelector('main section.panel h2:has-text("Skills of the fleet")');
  const boxes = await page.locator('.graph button.task').count();
  if (boxes !== count) throw new Error(`${boxes} tasks are drawn, not ${count}`);
}

/** The same with a computer that ends, over a network that is described; what is wrong is said beside its field. */
async function again(olga) {
  const { page } = olga;
  await press(page.getByText('Simulate it again, otherwise'));
  await page.getByLabel('Network').selectOption('own');
  await page.getByLabel('Delay, one way (ms)').fill('40000');
  const start = page.getByRole('button', { name: 'Simulate', exact: true });
  await page.waitForSelector('.field:has(input[aria-invalid=true]) :text("Write a number from 0 to 10000.")');
  if (await start.isEnabled()) olga.faults.push('it may be started with a delay of 40 s');
  await page.getByLabel('Delay, one way (ms)').fill('40');
  await press(page.getByRole('button', { name: '+ Add a fault' }));
  const fault = page.getByRole('group', { name: 'Fault 1' });
  for (const kind of ['rate', 'battery', 'disk', 'clock', 'partition', 'cut']) await fault.getByLabel('What goes wrong').selectOption(kind);
  await look(olga, 'plan-fault', { short: true, at: fault.getByRole('button', { name: 'Remove fault 1' }) });
  await fault.getByLabel('What goes wrong').selectOption('kill');
  await fault.getByLabel('Where').selectOption('ur3');
  await fault.getByLabel('When (s after the start of the run)').fill('1');
  await fault.getByLabel('For how long (s)').fill('9');
  await walk(olga);
  await look(olga, 'plan-again', { at: start });
  const before = await page.evaluate(() => location.hash);
  await press(start);
  await page.waitForFunction((was) => location.hash !== was, before);
  await page.waitForSelector('h2:has-text("What each task waited for")', DONE);
  await page.waitForSelector('h1:has-text("1 with a fault")');
  // Its computer was off, and the film says so.
  await page.getByLabel('Time of the film').press('Home');
  await press(page.getByRole('button', { name: 'To the next change' }));
  await press(page.getByRole('button', { name: 'To the next change' }));
  const told = await page.locator('.film .told').innerText();
  if (!/ur3: its computer is off/.test(told)) olga.faults.push(`at its second change ur3's computer is off, told is ${told}`);
  await look(olga, 'plan-film-fault', { at: page.locator('.film .chart') });
  // Its node was off as the belt was done: that wait is no task's.
  const waits = page.getByRole('region', { name: 'What each task waited for' });
  const rows = (await waits.locator('tbody tr').allInnerTexts()).map((text) => text.replaceAll(/\s+/g, ' '));
  const held = rows.find((row) => row.startsWith('put_down')) ?? '';
  if (!/run_belt; then \d+ s for something else/.test(held)) olga.faults.push(`put_down has waited for ur3's node, told is ${held}`);
  await look(olga, 'plan-waits', { at: waits });
}

/** With a stored scenario at the same time, which keeps the arm for a while: what the two cost each other is told. */
async function atOnce(olga) {
  const { page } = olga;
  await order('store', 'at the same time', [{ id: 'pick_first', robot: 'ur3', skill: 'pick', data: { side: 'left' } }]);
  await press(page.getByText('Simulate it again, otherwise'));
  await press(page.getByRole('button', { name: 'Remove fault 1' }));
  await press(page.getByRole('button', { name: '+ Add a scenario' }));
  const other = page.getByRole('group', { name: 'Scenario 2' });
  const start = page.getByRole('button', { name: 'Simulate', exact: true });
  await other.getByText('Choose a scenario.').waitFor();
  if (await start.isEnabled()) olga.faults.push('it may be started before a scenario is chosen');
  await other.getByLabel('Scenario', { exact: true }).selectOption({ label: 'at the same time' });
  await other.getByLabel('Starts later by (s)').fill('-1');
  await other.getByText('Write a number from 0 to 604800.').waitFor();
  await other.getByLabel('Starts later by (s)').fill('2');
  await walk(olga);
  await look(olga, 'plan-beside', { at: start });
  const before = await page.evaluate(() => location.hash);
  await press(start);
  await page.waitForFunction((was) => location.hash !== was, before);
  await page.waitForSelector('h2:has-text("What the runs cost each other")', DONE);
  await page.waitForSelector('h1:has-text("1 beside it")');
  const told = page.getByRole('region', { name: 'What the runs cost each other' });
  const rows = (await told.locator('tbody tr').allInnerTexts()).map((text) => text.replaceAll(/\s+/g, ' '));
  if (rows.length !== 2 || !/^1 to the picking place 0 s .* \d+ s in all, 1 task$/.test(rows[0])) olga.faults.push(`the arm was kept from the first run, told is ${rows}`);
  if (!/^2 at the same time 2 s .* 3 s 3 s –$/.test(rows[1] ?? '')) olga.faults.push(`the second run took 3 s, as alone, told is ${rows}`);
  const waits = page.getByRole('region', { name: 'Run 1, “to the picking place”' });
  const held = (await waits.locator('tbody tr').allInnerTexts()).find((text) => text.startsWith('put_down')) ?? '';
  if (!/ur3, which did pick_first of run 2/.test(held)) olga.faults.push(`put_down has waited for the other run, told is ${held}`);
  await look(olga, 'plan-runs-at-once', { at: told });
}

/** The run is played, stops, is moved by keys, in one time with its timeline. */
async function watch(olga) {
  const { page } = olga;
  const time = () => page.getByLabel('Time of the film').evaluate((one) => Number(one.value));
  const stage = (name) => page.locator(`.stages dt:has-text("${name}")`).innerText();
  await page.getByLabel('Speed', { exact: true }).selectOption('0.5');
  await press(page.getByRole('button', { name: 'Play' }));
  await page.waitForFunction(() => Number(document.querySelector('.film input[type=range]').value) > 0.2);
  const cursor = () => page.locator('.cursor').evaluate((one) => parseFloat(one.style.left));
  const left = await cursor();
  await page.waitForFunction((then) => parseFloat(document.querySelector('.cursor').style.left) > then, left); // both have one time
  await press(page.getByRole('button', { name: 'Pause' }));
  const stopped = await time();
  await page.getByLabel('Time of the film').press('ArrowRight');
  if ((await time()) <= stopped) olga.faults.push('the arrow key moves nothing');
  await page.getByLabel('Time of the film').press('Home');
  if (!/2$/.test(await stage('waits'))) olga.faults.push(`at first both tasks wait, told is ${await stage('waits')}`);
  await press(page.getByRole('button', { name: 'To the next change' }));
  const told = await page.locator('.film .told').innerText();
  if (!/conveyor does run_belt/.test(told)) olga.faults.push(`the first change is that the conveyor begins, told is ${told}`);
  await look(olga, 'plan-film', { short: true });
  await page.getByLabel('Time of the film').press('End');
  if (!/2$/.test(await stage('finished'))) olga.faults.push(`in the end both are done, told is ${await stage('finished')}`);
  await calm(olga, time);
  await walk(olga);
}

/** Who wants less motion sees a picture a second. */
async function calm(olga, time) {
  const { page } = olga;
  await page.emulateMedia({ reducedMotion: 'reduce' });
  await page.getByLabel('Speed', { exact: true }).selectOption('1');
  await page.evaluate(() => {
    globalThis.seen = new Set();
    globalThis.looking = setInterval(() => globalThis.seen.add(document.querySelector('.film input[type=range]').value), 20);
  });
  await press(page.getByRole('button', { name: 'Play' }));
  await page.waitForFunction(() => Number(document.querySelector('.film input[type=range]').value) > 1.5);
  const [seen, at] = await page.evaluate(() => {
    clearInterval(globalThis.looking);
    return [globalThis.seen.size, Number(document.querySelector('.film input[type=range]').value)];
  });
  // One a second, and what it was before it began.
  if (seen > at + 4.5) olga.faults.push(`with less motion ${seen} pictures were shown in ${at} s`);
  await press(page.getByRole('button', { name: 'Pause' }));
  await page.emulateMedia({ reducedMotion: 'no-preference' });
}

/** Two of the list, the newest is 0. */
async function compare(olga, [name, one, other]) {
  const { page } = olga;
  await olga.go('#/plan');
  const boxes = page.getByRole('button', { name: new RegExp(`^Compare .*${SCENARIO.name}`) });
  await boxes.nth(one).waitFor();
  await press(boxes.nth(one));
  await press(boxes.nth(other));
  await press(page.getByRole('button', { name: 'Compare two (2 of 2 chosen)' }));
  await page.waitForSelector('td:has-text("Messages: forward")');
  const row = (await page.locator('tr:has(td:has-text("All tasks took"))').innerText()).replaceAll(/\s+/g, ' ');
  if (!/\+\d+ %/.test(row)) olga.faults.push(`with a fault or a task more it takes longer, told is ${row}`);
  await look(olga, name, { short: true });
}

async function run(olga) {
  const { page } = olga;
  await page.waitForSelector('main header :text("can run")');
  await press(page.getByRole('button', { name: '▶ Run' }));
  await page.waitForFunction(() => location.hash.startsWith('#/runs/'));
  const id = await page.evaluate(() => location.hash.split('/')[2]);
  const state = await order('await_run', id);
  if (state !== 'FINISHED') throw new Error(`the run is ${state}`);
  return 'the run of what was tried is finished';
}
