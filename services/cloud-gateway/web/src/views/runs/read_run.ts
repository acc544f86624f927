/** A run that the live stream does not tell of: the scheduler may know it still, the archive has what is over. */
import { Problem } from '../../lib/api/problem';

const ROUTES = ['/api/v1/runs/{run}', '/api/v1/archive/{run}'];
export const MISSING = 'missing';

/** `why`: none has it (MISSING), or what went wrong; empty: it is there. */
export async function readRun<Run>(get: (route: string) => Promise<Run>): Promise<{ run?: Run; why: string }> {
  let why = '';
  for (const route of ROUTES) {
    try {
      return { run: await get(route), why: '' };
    } catch (problem) {
      if (problem instanceof Problem && problem.status === 404) continue; // the other one may have it
      why = problem instanceof Problem ? problem.detail : String(problem);
    }
  }
  return { why: why || MISSING };
}
