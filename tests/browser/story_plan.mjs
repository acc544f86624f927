/** An operator plans: simulates two fleets, sees the numbers, compares them, cancels a third one. */
import { walk } from './keyboard.mjs';
import { look } from './look.mjs';
import { Person } from './person.mjs';

const DONE = { timeout: 60_000 };

export async function plans(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  await olga.enter();
  const { page } = olga;
  await olga.go('#/plan');
  await look(olga, 'plan');

  // As it stands there: 5 robots, 9 tasks, over Wi-Fi.
  const began = Date.now();
  await simulate(page);
  await result(page);
  const took = Date.now() - began;
  const shown = await page.locator('main').innerText();
  for (const wanted of ['5 robots, 9 tasks, TalkRoBots, Wi-Fi, seed 1', 'FINISHED', '9 / 9', 'identification', 'upkeep']) {
    if (!shown.toLowerCase().includes(wanted.toLowerCase())) olga.faults.push(`the result does not say "${wanted}"`);
  }
  const model = await cell(page, 'task', 3);
  if (model !== '72') olga.faults.push(`Equation 12 gives 72 task messages for nine tasks field by field, shown is ${model}`);
  await page.waitForSelector('.chart canvas');
  if ((await page.locator('.area .bar').count()) !== 9) olga.faults.push('the timeline has not nine bars');
  await page.locator('table a.row-name').first().press('Enter');
  await page.waitForSelector('h1:has-text("5 robots")');
  await result(page);
  await page.waitForSelector('.chart canvas');
  await look(olga, 'plan-result');
  await olga.go('#/plan');

  // By keys: one robot breaks, and the paper's protocol.
  await page.getByLabel('Robots with a fault').press('ArrowRight');
  await simulate(page);
  await page.waitForFunction(() => document.querySelectorAll('.area .bar.critical').length === 1, null, DONE);
  await page.getByLabel('Protocol').selectOption('paper');
  await simulate(page);
  await page.waitForFunction(() => document.querySelector('main').innerText.includes('the paper’s, 1 with a fault'), null, DONE);
  await result(page);
  const [counted, wanted] = [await cell(page, 'task', 2), await cell(page, 'task', 3)];
  if (counted !== wanted || counted !== '36') olga.faults.push(`of the paper's protocol ${counted} task messages were counted, Equation 12 gives ${wanted}, not 36`);

  await compare(olga);
  await cancel(olga);
  await walk(olga);
  return `a result ${took} ms after the start`;
}

const simulate = (page) => page.getByRole('button', { name: 'Simulate', exact: true }).press('Enter');
const result = (page) => page.waitForSelector('h2:has-text("By phase")', DONE);
const cell = async (page, phase, column) =>
  (await page.locator(`tr:has(td:first-child > div:text-is("${phase}")) > td:nth-child(${column})`).first().innerText()).trim();

async function compare(olga) {
  const { page } = olga;
  const boxes = page.getByRole('button', { name: /^Compare \d/ });
  await boxes.nth(2).waitFor(); // the list is read each second
  await boxes.nth(1).press('Enter');
  await boxes.nth(2).press('Enter');
  await page.getByRole('button', { name: 'Compare two (2 of 2 chosen)' }).press('Enter');
  await page.waitForSelector('td:has-text("Messages: forward")');
  await page.waitForSelector('.chart canvas');
  const row = await page.locator('tr:has(td:has-text("All tasks took"))').innerText();
  if (!/%/.test(row)) olga.faults.push(`no change is told: ${row}`);
  await look(olga, 'plan-compare');
  await olga.go('#/plan');
}

/** One that would take its whole minute. */
async function cancel(olga) {
  const { page } = olga;
  for (const [label, key] of [['Robots', 'End'], ['Tasks', 'End']]) await page.getByLabel(label, { exact: true }).press(key);
  await simulate(page);
  await page.waitForSelector('progress', DONE);
  await look(olga, 'plan-runs', { short: true });
  await page.locator('header').getByRole('button', { name: 'Cancel', exact: true }).press('Enter');
  await page.waitForFunction(() => /cancelled/.test(document.querySelector('main').innerText) && !document.querySelector('main progress'));
  await page.getByRole('button', { name: /^Forget: 40 robots, 200 tasks/ }).press('Enter');
  await page.waitForFunction(() => !/40 robots, 200 tasks/.test(document.querySelector('table').innerText));
}
