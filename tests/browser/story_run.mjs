/** A run is held and ended with a reason: who did it is said, and it is listed once, as over. */
import { look } from './look.mjs';
import { Person } from './person.mjs';
import { press } from './press.mjs';
import { order } from './starter.mjs';

const ROBOT = 'pioneer2';

export async function runEnded(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  await olga.enter();
  const { page } = olga;
  const run = await order('begin', ROBOT);
  await olga.go(`#/runs/${run}`);
  await orderWith(page, 'Pause', 'lunch');
  await page.locator('.waits', { hasText: 'by olga: lunch' }).waitFor();
  await olga.go('#/runs');
  await listed(page, run, 'Under way');
  await olga.go(`#/runs/${run}`);
  await orderWith(page, 'End the run', 'the shift ends');
  await page.locator('dd', { hasText: 'cloud: by olga: the shift ends' }).waitFor();
  await look(olga, 'run-ended', { short: true });
  await olga.go('#/runs');
  await listed(page, run, 'Over');
  await look(olga, 'runs-over', { short: true });
}

async function orderWith(page, name, reason) {
  await press(page.getByRole('button', { name, exact: true }));
  const dialog = page.getByRole('dialog');
  await dialog.getByLabel('Reason').fill(reason);
  await press(dialog.getByRole('button', { name, exact: true }));
}

/** Under this title, and under no other. */
async function listed(page, run, title) {
  const line = page.locator('tr', { has: page.locator(`a[href="#/runs/${run}"]`) });
  const under = page.locator('main section', { has: page.getByRole('heading', { name: title, exact: true }) });
  await under.locator(line).waitFor();
  if ((await line.count()) !== 1) throw new Error(`the run is listed ${await line.count()} times`);
}
