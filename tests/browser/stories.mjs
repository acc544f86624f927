/** The stories, one after the other, of one fleet: node stories.mjs SETTINGS; run.py starts it. */
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { startBrowser } from './person.mjs';
import { order } from './starter.mjs';
import { alarms, changesSettings } from './story_alarm.mjs';
import { certificateEnds } from './story_certificate.mjs';
import { signsIn } from './story_sign_in.mjs';
import { drives, leavesDriven } from './story_control.mjs';
import { hostileTexts } from './story_hostile.mjs';
import { manyRobots } from './story_many.mjs';
import { paper } from './story_paper.mjs';
import { plans } from './story_plan.mjs';
import { refusedAndAsked } from './story_refused.mjs';
import { robotFollowed } from './story_robot.mjs';
import { runEnded } from './story_run.mjs';
import { triesAScenario } from './story_try.mjs';
import { connectionLost, everyView, everyViewInFrench, keyboardAlone, sourcesSilent, stopsAll } from './story_views.mjs';

const settings = JSON.parse(process.argv[2]);
const stories = [
  ['somebody signs in by keyboard alone; a wrong password is told', signsIn],
  ['the paper, section 6.1: a run, a fault, a decision', paper],
  ['an alarm is seen, shelved with a reason, taken back; in a dialog "Stop all" is within reach', alarms],
  ['a certificate that ends soon is told in every view, until it is renewed', certificateEnds],
  ['an admin changes who decides, and is told what is out of bounds', changesSettings],
  ['an operator plans: two simulations, compared; a third one cancelled', plans],
  ['a scenario from the editor is tried in Plan, changed, compared, run', triesAScenario],
  ['the view of a robot follows it: stopped by the page or by another, released', robotFollowed],
  ['a run is held and ended with a reason: who did it is said, and it is listed as over alone', runEnded],
  ['a robot is stopped amid its task: its alert says why somebody has to look; a refusal names its robot, and goes with its view', refusedAndAsked],
  ['a robot is driven by hand, stopped, handed over, and stands when its page is gone', drives],
  ['Back leads away from a robot that is driven by hand: it is let go', leavesDriven],
  ['every view in each size and colour: axe, console, origin', everyView],
  ['every view in French', everyViewInFrench],
  ['every control of every view is reached by Tab, and shows the focus', keyboardAlone],
  ['Shift+Esc stops all, in every view; that all are released is said', stopsAll],
  ['forty more robots with long names: no state is out of sight, and who has not confirmed a stop is told on a phone, too', manyRobots],
  ['hostile texts of robots, sensors, scenarios, users, messages are shown as text', hostileTexts],
  ['who tells of alerts and runs is silent: no view says that there is none', sourcesSilent],
  ['the gateway is killed: the page says so within 3 s, and is back by itself within 3 s', connectionLost],
].filter(([title]) => title.includes(settings.only));

const began = Date.now();
const browser = await startBrowser();
const people = [];
let failed = 0;
for (const [title, story] of stories) {
  const start = Date.now();
  const before = people.length;
  const faults = [];
  let told = '';
  try {
    told = (await story(browser, settings, people)) ?? '';
  } catch (error) {
    faults.push(error.stack);
    await keepPicture(people.at(-1), title);
  }
  for (const person of people) faults.push(...person.faults.splice(0));
  for (const person of people.splice(before)) await leave(person);
  if (faults.length > 0) await order('mend').catch((error) => faults.push(`what it left is not mended: ${error.message}`));
  const unique = [...new Set(faults)];
  console.log(`${unique.length === 0 ? 'ok  ' : 'FAIL'} ${title} (${((Date.now() - start) / 1000).toFixed(1)} s)${told ? `: ${told}` : ''}`);
  for (const fault of unique) console.log(`     ${fault}`);
  failed += unique.length === 0 ? 0 : 1;
}
await browser.close();
console.log(`== the page in Chromium: ${stories.length - failed} of ${stories.length} stories as they should be, ${((Date.now() - began) / 1000).toFixed(0)} s`);
process.exit(failed === 0 ? 0 : 1);

/** An answer that a story has still in its hands is let go, before its page is. */
async function leave({ page, context }) {
  if (!page.isClosed()) await page.unrouteAll({ behavior: 'ignoreErrors' });
  await context.close();
}

async function keepPicture(person, title) {
  if (!settings.pictures || !person) return;
  mkdirSync(settings.pictures, { recursive: true });
  const name = title.replaceAll(/[^a-z]+/gi, '-').slice(0, 40);
  await person.page.screenshot({ path: join(settings.pictures, `failed-${name}.png`), caret: 'initial' }).catch(() => undefined);
}
