/**
 * The check of what is drawn, without a view: a moment after each change, and again until it has an answer.
 *
 * | State   | Event                                     | Does                       | Next    |
 * |---------|-------------------------------------------|----------------------------|---------|
 * | any     | another scenario                          | drops the request          | waiting |
 * | waiting | the same is wanted again                  |                            | waiting |
 * | waiting | the time is over (0.4 s, after a failure 2 s) | drops the request, asks | asked   |
 * | asked   | the same is wanted again: robots came or went |                        | waiting |
 * | asked   | answer, refusal                           | shows it                   | idle    |
 * | asked   | failure that may pass                     | shows it                   | waiting |
 * | idle    | the same is wanted again                  |                            | waiting |
 * | any     | stop                                      | drops the request          | idle    |
 */
import { Problem } from '../../lib/api/problem';
import type { Schemas } from '../../lib/api/types';
import type { Scenario } from '../../lib/scenario/scenario_model';

export type Checked = Schemas['ScenarioCheck'];

const AFTER_MS = 400;
const AGAIN_MS = 2000;

/** The gateway, its fleet or the network may do better in a moment. */
function mayPass(problem: unknown): boolean {
  return !(problem instanceof Problem) || problem.isUnreachable || problem.status === 429 || problem.status >= 500;
}

export class CheckLoop {
  private wanted: Scenario | undefined;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private request = new AbortController();

  /** `show`: what the check found; or nothing, and why there is none. */
  constructor(
    private readonly ask: (scenario: Scenario, signal: AbortSignal) => Promise<Checked>,
    private readonly show: (check: Checked | undefined, why: string) => void,
  ) {}

  /** Again with the same one: the fleet has changed. */
  want(scenario: Scenario): void {
    if (scenario !== this.wanted) this.stop();
    this.wanted = scenario;
    this.wait(scenario, AFTER_MS);
  }

  stop(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
    this.wanted = undefined;
    this.request.abort();
  }

  private wait(scenario: Scenario, ms: number): void {
    this.timer ??= setTimeout(() => void this.check(scenario), ms);
  }

  private async check(scenario: Scenario): Promise<void> {
    this.timer = undefined;
    this.request.abort();
    const { signal } = (this.request = new AbortController());
    try {
      const check = await this.ask(scenario, signal);
      if (!signal.aborted) this.show(check, '');
    } catch (problem) {
      if (!signal.aborted) this.failed(scenario, problem);
    }
  }

  private failed(scenario: Scenario, problem: unknown): void {
    const faults = problem instanceof Problem ? problem.faults : [];
    if (mayPass(problem) || faults.length === 0) this.show(undefined, problem instanceof Problem ? problem.detail : String(problem));
    else this.show({ good: false, faults: faults.map((one) => ({ ...one, warning: false })), without_spare: [] }, '');
    if (mayPass(problem)) this.wait(scenario, AGAIN_MS);
  }
}
