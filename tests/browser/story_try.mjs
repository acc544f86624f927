/** A scenario from the editor is tried in Plan, changed, tried again, compared with the first, and run. */
import { look } from './look.mjs';
import { Person } from './person.mjs';
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
  await back(olga, 2);
  await drawTask(olga, MORE, 2);
  const second = await tried(olga, 3);
  if (first === second) throw new Error('the second try is the first one');
  await compare(olga);
  await page.locator('main li a').nth(1).press('Enter');
  await page.waitForSelector('h2:has-text("What each task waited for")', DONE);
  await back(olga, 3);
  return run(olga);
}

/** Not saved: what is drawn is tried, and the result names what was waited for. */
async function tried(olga, count) {
  const { page } = olga;
  await page.waitForSelector('main header :text("can run")');
  await page.getByRole('button', { name: 'Try in Plan' }).press('Enter');
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
  await page.getByRole('link', { name: 'Back to the scenario' }).press('Enter');
  await page.waitForSelector('main section.panel h2:has-text("Skills of the fleet")');
  const boxes = await page.locator('.graph button.task').count();
  if (boxes !== count) throw new Error(`${boxes} tasks are drawn, not ${count}`);
}

/** The newest two of the list. */
async function compare(olga) {
  const { page } = olga;
  await olga.go('#/plan');
  const boxes = page.getByRole('button', { name: new RegExp(`^Compare .*${SCENARIO.name}`) });
  await boxes.nth(1).waitFor();
  await boxes.nth(1).press('Enter');
  await boxes.nth(0).press('Enter');
  await page.getByRole('button', { name: 'Compare two (2 of 2 chosen)' }).press('Enter');
  await page.waitForSelector('td:has-text("Messages: forward")');
  const row = (await page.locator('tr:has(td:has-text("All tasks took"))').innerText()).replaceAll(/\s+/g, ' ');
  if (!/\+\d+ %/.test(row)) olga.faults.push(`with a task more it takes longer, told is ${row}`);
  await look(olga, 'plan-scenario-compare', { short: true });
}

async function run(olga) {
  const { page } = olga;
  await page.waitForSelector('main header :text("can run")');
  await page.getByRole('button', { name: '▶ Run' }).press('Enter');
  await page.waitForFunction(() => location.hash.startsWith('#/runs/'));
  const id = await page.evaluate(() => location.hash.split('/')[2]);
  const state = await order('await_run', id);
  if (state !== 'FINISHED') throw new Error(`the run is ${state}`);
  return 'the run of what was tried is finished';
}
