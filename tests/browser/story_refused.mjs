/** A robot is stopped amid its task: its alert says why somebody has to look. What refuses an order names its robot, and goes with its view. */
import { look } from './look.mjs';
import { Person } from './person.mjs';
import { press } from './press.mjs';
import { order } from './starter.mjs';

const ROBOT = 'pioneer1';
const SAID = 'it still says "a wheel is loose"';

export async function refusedAndAsked(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  await olga.enter();
  const { page } = olga;
  const run = await order('stop_amid', ROBOT);
  await olga.go(`#/runs/${run}`);
  const alarm = page.locator('a.alarm', { hasText: ROBOT });
  await press(alarm);
  await page.locator('.word', { hasText: `Look whether ${ROBOT} stands, and say so in your decision: nobody knows what became of task 'there'.` }).waitFor();
  await look(olga, 'alert-asked');
  const alert = new URL(page.url()).hash;

  await olga.go(`#/robots/${ROBOT}`);
  await refusal(olga);
  const toast = page.locator('.toast', { hasText: `${ROBOT}: ${SAID}` });
  await toast.waitFor();
  await look(olga, 'robot-refused', { short: true });
  await olga.go(alert);
  await toast.waitFor({ state: 'detached' });

  await order('release');
  await olga.go(`#/runs/${run}`);
  await press(page.getByRole('button', { name: 'End the run', exact: true }));
  await page.getByRole('dialog').getByLabel('Reason').fill('it was stopped');
  await press(page.getByRole('dialog').getByRole('button', { name: 'End the run', exact: true }));
  await alarm.waitFor({ state: 'detached' });
  await page.locator('main .box', { hasText: 'not begun' }).waitFor();
}

/** As a gateway answers whose robot says so: none of the fleet's does now. */
async function refusal(olga) {
  const { page } = olga;
  const body = JSON.stringify({ type: 'about:blank/conflict', title: 'conflict', status: 409, detail: SAID });
  olga.expected.push(/status of 409 .*\/release$/);
  await page.route('**/release', (route) => route.fulfill({ status: 409, contentType: 'application/problem+json', body }), { times: 1 });
  await press(page.locator('main .head').getByRole('button', { name: 'Release', exact: true }));
  await press(page.getByRole('dialog').getByRole('button', { name: 'Release', exact: true }));
}
