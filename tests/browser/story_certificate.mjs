/** A certificate that ends soon is told in every view, until it is renewed. */
import { look } from './look.mjs';
import { Person } from './person.mjs';
import { press } from './press.mjs';
import { order } from './starter.mjs';

const HEARD_MS = 30000; // the gateway reads every 2 s which nodes there are

export async function certificateEnds(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  await olga.enter();
  const { page } = olga;
  const line = page.locator('a.ending');
  if (await line.count() > 0) throw new Error(`with certificates of a year: ${await line.textContent()}`);
  await order('renew', 'ur3', 20);
  await order('renew', 'drone', 2);
  await line.getByText(/The certificate of drone ends on .*, in 1 day\. .*trb fleet renew.*\(1 more\)/s).waitFor({ timeout: HEARD_MS });
  await look(olga, 'certificate-ends');
  await press(line);
  const ends = new Date(Date.now() + 20 * 24 * 3600 * 1000).toLocaleDateString('en-GB'); // as his browser writes it
  await page.locator('main tr', { hasText: 'ur3' }).getByText(ends).waitFor();
  await order('renew', 'drone', 365);
  await line.getByText(/The certificate of ur3 ends on .*, in 19 days\./).waitFor({ timeout: HEARD_MS });
  await order('renew', 'ur3', 365);
  await line.waitFor({ state: 'detached', timeout: HEARD_MS });
}
