/** What only the starter of the fleet (run.py) can do: an order is a line of standard output, its answer one of standard input. */
import { createInterface } from 'node:readline';

const answers = createInterface({ input: process.stdin })[Symbol.asyncIterator]();

export async function order(name, ...words) {
  process.stdout.write(`@${JSON.stringify([name, ...words])}\n`);
  const { value, done } = await answers.next();
  const answer = done ? { error: 'the starter has ended' } : JSON.parse(value);
  if (answer.error) throw new Error(`${name}: ${answer.error}`);
  return answer.value;
}
