/** An operator plans: simulates two fleets, sees the numbers, compares them, cancels a third one; runs that do not end say why. */
import { walk } from './keyboard.mjs';
import { look } from './look.mjs';
import { Person } from './person.mjs';
import { press } from './press.mjs';

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
  await press(page.locator('table a.row-name').first());
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
  await tells(olga);
  await walk(olga);
  return `a result ${took} ms after the start`;
}

const simulate = (page) => press(page.getByRole('button', { name: 'Simulate', exact: true }));
const result = (page) => page.waitForSelector('h2:has-text("By phase")', DONE);
const cell = async (page, phase, column) =>
  (await page.locator(`tr:has(td:first-child > div:text-is("${phase}")) > td:nth-child(${column})`).first().innerText()).trim();

async function compare(olga) {
  const { page } = olga;
  const boxes = page.getByRole('button', { name: /^Compare \d/ });
  await boxes.nth(2).waitFor(); // the list is read each second
  await press(boxes.nth(1));
  await press(boxes.nth(2));
  await press(page.getByRole('button', { name: 'Compare two (2 of 2 chosen)' }));
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
  await press(page.locator('header').getByRole('button', { name: 'Cancel', exact: true }));
  await page.waitForFunction(() => /cancelled/.test(document.querySelector('main').innerText) && !document.querySelector('main progress'));
  await press(page.getByRole('button', { name: /^Forget: 40 robots, 200 tasks/ }));
  await page.waitForFunction(() => !/40 robots, 200 tasks/.test(document.querySelector('table').innerText));
}

/** A fault behind the end is told as not reached; a run that nobody ends says what it waits for, and that its links were not up. */
async function tells(olga) {
  const { page } = olga;
  await page.getByLabel('Robots', { exact: true }).press('Home');
  await page.getByLabel('Robots', { exact: true }).press('ArrowRight');
  await page.getByLabel('Tasks', { exact: true }).fill('9'); // what was cancelled may take longer than anybody waits
  await addFault(page, 1, { what: 'fail', where: 'r1', when: '5000' });
  await simulate(page);
  await says(olga, ['Not reached', 'a robot breaks: r1, at 1:23:20']);
  await press(page.getByRole('button', { name: 'Remove fault 1' }));
  await addFault(page, 1, { what: 'cut', where: 'r1', when: '' });
  await addFault(page, 2, { what: 'fail', where: 'r0', when: '5' });
  await simulate(page);
  await says(olga, ['it waits for a person', 'in a simulation nobody decides: r0', 'It stands still: nothing has moved for', 'Not all links were up: after 1:00']);
  await look(olga, 'plan-stands', { at: page.getByRole('heading', { name: 'How it ended' }) });
  await inFrench(olga);
}

/** The same alone on its page. */
async function inFrench(olga) {
  const { page } = olga;
  await press(page.locator('table a.row-name').first());
  await page.waitForSelector('h1:has-text("2 robots")');
  await page.evaluate(() => localStorage.setItem('trb.language', 'fr'));
  await page.reload();
  await says(olga, ['elle attend une personne', 'personne ne décide : r0', 'Elle n’avance plus', 'Des liaisons manquaient']);
  await look(olga, 'plan-stands-fr', { short: true });
  await page.evaluate(() => localStorage.setItem('trb.language', 'en'));
  await page.reload();
  await olga.go('#/plan');
  await page.getByLabel('Robots', { exact: true }).waitFor();
}

async function addFault(page, number, { what, where, when }) {
  await press(page.getByRole('button', { name: '+ Add a fault' }));
  const fault = page.getByRole('group', { name: `Fault ${number}` });
  await fault.getByLabel('What goes wrong').selectOption(what);
  await fault.getByLabel('Where').selectOption(where);
  await fault.getByLabel('When (s after the start of the run)').fill(when);
}

async function says(olga, words) {
  await olga.page.waitForFunction((first) => document.querySelector('main')?.innerText.includes(first), words[0], DONE);
  const shown = (await olga.page.locator('main').innerText()).replaceAll('\u00a0', ' '); // where French breaks no line
  for (const word of words) if (!shown.includes(word)) olga.faults.push(`the result does not say "${word}"`);
}
