/** A hall with forty more robots, some with the longest names: each state is in sight, and so is what became of a stop. */
import { look } from './look.mjs';
import { Person } from './person.mjs';

const MORE = 40;
/** The longest that a node's id may be is 64 characters, without a place where a line may be broken. */
const names = Array.from({ length: MORE }, (_, i) => (i % 5 === 0 ? `${'hall_north_line_'.repeat(4).slice(0, 61)}${100 + i}` : `robot-${i}`));
const STATES = ['unreachable', 'sent', 'confirmed'];

export async function manyRobots(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  const { page } = olga;
  await page.routeWebSocket(/\/api\/v1\/live/, (socket) => socket.connectToServer().onMessage((text) => socket.send(withMore(String(text)))));
  await page.route(/\/robots\/(hall_|robot-)[^/]*\/skills$/, async (route) =>
    route.fulfill({ response: await route.fetch({ url: route.request().url().replace(/robots\/[^/]+/, 'robots/pioneer1') }) }));
  await page.route('**/api/v1/stop', (route) => route.fulfill({ json: { robots: names.map((robot, i) => ({ robot, state: STATES[i % 3], text: '' })) } }));
  await olga.enter();
  await olga.go('#/hall');
  await page.locator('main tbody tr').nth(MORE + 8).waitFor();
  await look(olga, 'many-hall');
  for (const width of [1024, 1366]) {
    await page.setViewportSize({ width, height: 768 });
    const beside = await page.locator('main [role=region]').evaluate((one) => one.scrollWidth - one.clientWidth);
    if (beside > 1) olga.faults.push(`at ${width} px columns of the robots lie ${beside} px out of sight`);
  }
  for (const [width, height] of [[390, 844], [844, 390]]) await stopStays(olga, width, height);
  await stops(olga);
  return `${MORE} more robots`;
}

/** On a phone, however it is held, the stop of all is not scrolled away. */
async function stopStays({ page, faults }, width, height) {
  await page.setViewportSize({ width, height });
  await page.locator('main tbody tr').nth(MORE).scrollIntoViewIfNeeded();
  const { y } = await page.getByRole('button', { name: /Stop all/ }).boundingBox();
  if (y < 0 || y > height / 2) faults.push(`at ${width} x ${height} px "Stop all" is at ${Math.round(y)} px`);
}

/** Told at its top to who has scrolled down on a phone, too, and nothing of it is hidden in a part that scrolls. */
async function stops({ page, faults }) {
  await page.setViewportSize({ width: 390, height: 844 });
  await page.locator('main tbody tr').nth(MORE).scrollIntoViewIfNeeded();
  await page.getByRole('button', { name: /Stop all/ }).click();
  const told = page.getByText(/NOT all have confirmed the stop of .*: 27 of 40 are missing/);
  await told.waitFor();
  await page.waitForFunction((one) => one.getBoundingClientRect().top >= 0, await told.elementHandle(), { timeout: 5000 })
    .catch(() => faults.push('what became of the stop is not in sight on a phone'));
  const lines = page.locator('.bar li');
  if ((await lines.count()) !== 2) faults.push(`those who are missing take ${await lines.count()} lines, not one for each reason`);
  const hidden = await page.locator('.bar').evaluate((bar) => [bar, ...bar.querySelectorAll('*')].filter((one) => one.scrollHeight - one.clientHeight > 1).length);
  if (hidden > 0) faults.push('a part of what became of the stop has to be scrolled for');
  await page.locator('.bar').getByRole('button', { name: 'Close' }).click();
}

/** A word of the live stream, in which the fleet has more robots. Its instance has 64 bits: a number would lose some. */
function withMore(text) {
  const word = JSON.parse(text);
  const block = word.blocks?.find(({ topic, rows }) => topic === 'fleet' && rows.some(isRobot));
  if (!block?.snapshot) return text;
  const model = block.rows.find(isRobot);
  block.rows.push(...names.map((node, i) => ({ ...model, node, content: { ...model.content, connection: i % 7 === 0 ? 'OFFLINE' : 'ONLINE' } })));
  const [, instance] = /"instance":(\d+)/.exec(text);
  return JSON.stringify(word).replace(/"instance":\d+/, `"instance":${instance}`);
}

const isRobot = (row) => row.kind === 'robot' && !row.removed;
