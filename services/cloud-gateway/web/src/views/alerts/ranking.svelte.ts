/** The ranking of one open alert by other weights or judgments, asked for as they are moved. The alert stays as it is. */
import { api, Problem } from '../../lib/api/client';
import { pageHints } from '../../lib/api/problem';
import type { Schemas } from '../../lib/api/types';
import { live } from '../../lib/live/live.svelte';
import { Latest } from './latest';
import type { Judgments, Weight } from './weighing';

export type Ranking = Schemas['AlertRanking'];
type Wish = { weights: Weight[] } | { judgments: Judgments } | null;

export class LiveRanking {
  answer = $state.raw<Ranking | null>(null);
  /** The answer to no wish: the weights in force. */
  inForce = $state.raw<Weight[]>([]);
  problem = $state('');
  isBusy = $state(false);
  /** When it was answered: ISO 8601. */
  at = $state('');
  private wish: Wish = null;
  private readonly abort = new AbortController();
  private readonly latest = new Latest<Wish>((wish) => this.send(wish));

  constructor(private readonly alert: string) {}

  weigh(weights: Weight[]): void {
    this.want({ weights });
  }

  judge(judgments: Judgments): void {
    this.want({ judgments });
  }

  reset(): void {
    this.want(null);
  }

  /** The robots are asked anew. */
  again(): void {
    this.want(this.wish);
  }

  end(): void {
    this.latest.drop();
    this.abort.abort();
  }

  private want(wish: Wish): void {
    this.wish = wish;
    void this.latest.want(wish);
  }

  private async send(wish: Wish): Promise<void> {
    this.isBusy = true;
    try {
      const ask = { path: { alert: this.alert }, body: bodyOf(wish), signal: this.abort.signal, isQuestion: true as const };
      this.answer = await api.post<Ranking>('/api/v1/alerts/{alert}/ranking', ask);
      if (wish === null) this.inForce = this.answer.weights;
      this.at = new Date(live.utcMs()).toISOString();
      this.problem = '';
    } catch (error) {
      if (!this.abort.signal.aborted) this.problem = error instanceof Problem ? [error.detail, ...pageHints(error.hints)].join('. ') : String(error);
    }
    this.isBusy = false;
  }
}

function bodyOf(wish: Wish): Schemas['RankingWish'] {
  if (wish === null) return {};
  if ('judgments' in wish) return { judgments: wish.judgments };
  return { weights: Object.fromEntries(wish.weights.map((one) => [one.criterion, one.weight])) };
}
