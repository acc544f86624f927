/** Alerts as alarms: seen, shelved with a reason, taken back; with a dialog open "Stop all" is within reach. */
import { look } from './look.mjs';
import { Person } from './person.mjs';
import { press } from './press.mjs';
import { order } from './starter.mjs';

const ALERT_MS = 60000;

export async function alarms(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  await olga.enter();
  const { page } = olga;
  await repaired(page);
  const robot = await order('fault', 'mobile');
  await page.waitForSelector(`a.alarm:has-text("${robot}")`, { timeout: ALERT_MS });
  await olga.go('#/alerts');
  const line = page.locator('main tr', { hasText: robot }).first();
  await press(line.getByRole('button', { name: `I have seen it: ${robot}` }));
  await line.getByText('seen by olga').waitFor();
  await page.locator('a.alarm', { hasText: 'seen by olga' }).waitFor();
  await press(line.locator('a.robot'));
  await page.waitForSelector(`h1:has-text("${robot}")`);
  await shelve(olga);
  await page.waitForSelector('a.alarm', { state: 'detached' });
  await olga.go('#/alerts');
  await page.getByRole('heading', { name: 'Shelved alerts' }).waitFor();
  await look(olga, 'alerts-shelved');
  await press(page.getByRole('button', { name: `Take back: ${robot}` }));
  await page.getByRole('heading', { name: 'Shelved alerts' }).waitFor({ state: 'detached' });
  await page.locator('a.alarm', { hasText: robot }).waitFor();
  await order('repair', robot);
  await page.waitForSelector('a.alarm', { state: 'detached', timeout: ALERT_MS });
  await olga.openMenu();
  await stopWithin(olga, page.getByRole('dialog'));
}

/** What a story before has left broken would call first, and longer. */
async function repaired(page) {
  const others = page.locator('a.alarm strong');
  await page.getByRole('link', { name: 'ridgeback' }).first().waitFor(); // the hall is there, and alarms with it
  if (await others.count() > 0) await order('repair', await others.first().textContent());
  await others.waitFor({ state: 'detached', timeout: ALERT_MS });
}

/** Without a reason nothing is shelved. */
async function shelve(olga) {
  const { page } = olga;
  await press(page.getByRole('button', { name: 'Shelve', exact: true }));
  const dialog = page.getByRole('dialog');
  await dialog.getByRole('heading', { name: /^Shelve/ }).waitFor();
  if (await dialog.getByRole('button', { name: /Stop all/ }).evaluate((one) => one === document.activeElement)) olga.faults.push('a second Enter would stop the hall');
  await dialog.getByLabel('For how long').selectOption('60');
  await look(olga, 'alert-shelve');
  await press(dialog.getByRole('button', { name: 'Shelve', exact: true }));
  await dialog.locator('input:invalid').waitFor();
  await dialog.getByLabel('Reason').fill('the wheel comes at noon');
  await refusedInSight(olga, dialog);
  await press(dialog.getByRole('button', { name: 'Shelve', exact: true }));
  await dialog.waitFor({ state: 'detached' });
  await page.locator('main', { hasText: 'shelved by olga until' }).getByText('the wheel comes at noon').waitFor();
}

/** What is refused is told in the dialog: behind it nobody could read or close it. */
async function refusedInSight(olga, dialog) {
  const detail = 'vic has shelved it already';
  olga.expected.push(/status of 409 .*\/shelve$/);
  await olga.page.route('**/shelve', (route) => route.fulfill({ status: 409, contentType: 'application/problem+json', json: { title: 'Conflict', status: 409, detail } }));
  await press(dialog.getByRole('button', { name: 'Shelve', exact: true }));
  const told = dialog.locator('.toast', { hasText: detail });
  await told.getByRole('button', { name: 'Close' }).click();
  await told.waitFor({ state: 'detached' });
  await olga.page.unroute('**/shelve');
  olga.expected.pop();
}

/** What is open does not lie above the stop, nor above what became of it. */
async function stopWithin(olga, dialog) {
  await dialog.getByRole('button', { name: /Stop all/ }).click();
  await dialog.getByText(/Stopped: (\d+) of \1 have confirmed/).waitFor();
  await look(olga, 'dialog-stopped');
  await order('release');
  await dialog.getByRole('alert').getByRole('button', { name: 'Close' }).click();
}

async function refusedAtItsField(admin, moves, save) {
  await moves.fill('99');
  admin.expected.push(/status of 422 .*\/api\/v1\/policy$/);
  await press(save);
  await admin.page.locator('main [aria-invalid=true]').waitFor();
  await look(admin, 'settings-refused');
  admin.expected.pop();
}

/** An admin changes who decides; what is out of bounds is told at its field. */
export async function changesSettings(browser, settings, people) {
  const admin = await Person.arrive(browser, settings, 'admin');
  people.push(admin);
  await admin.enter();
  const { page } = admin;
  await admin.go('#/settings');
  const moves = page.getByLabel('Moves of one task');
  const save = page.getByRole('button', { name: 'Put the policy in force' });
  // Prism would refuse it in the gateway's place, in words of its own.
  if (!settings.judged) await refusedAtItsField(admin, moves, save);
  await moves.fill('3');
  await press(save);
  await page.getByText('It is in force.').first().waitFor({ timeout: ALERT_MS });
  await admin.go('#/hall');
  await admin.go('#/settings');
  if ((await moves.inputValue()) !== '3') throw new Error(`moves are ${await moves.inputValue()} after a change to 3`);
}
