/** The view of one robot follows it, whoever stops it. */
import { look } from './look.mjs';
import { Person } from './person.mjs';
import { press } from './press.mjs';
import { order } from './starter.mjs';

const ROBOT = 'pioneer1';

export async function robotFollowed(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  await olga.enter();
  await olga.go(`#/robots/${ROBOT}`);
  const { page } = olga;
  const head = page.locator('main .head');
  const stopped = head.getByText('stopped');
  const release = head.getByRole('button', { name: 'Release', exact: true });
  await release.and(page.locator(':disabled')).waitFor();
  await press(head.getByRole('button', { name: 'Stop', exact: true }));
  await stopped.waitFor();
  await look(olga, 'robot-stopped');
  await press(release);
  await press(page.getByRole('dialog').getByRole('button', { name: 'Release', exact: true }));
  await stopped.waitFor({ state: 'detached' });
  await order('stop', ROBOT); // by trb, as another person does
  await stopped.waitFor();
  await order('release');
  await stopped.waitFor({ state: 'detached' });
}
