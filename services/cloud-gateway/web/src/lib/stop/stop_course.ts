/** What has become of a stop since it was answered, as the live rows tell: who still stands by it, and whether it is over. */
import type { RobotContent, RobotOrder, Row } from '../api/types';

/** A row shows within this that its robot was stopped. */
const SHOWN_MS = 10000;

/** Their names by what `of` says of each; of whom it says nothing is left out. */
export function namesBy(robots: readonly RobotOrder[], of: (one: RobotOrder) => string): [string, string][] {
  const names = new Map<string, string[]>();
  for (const one of robots.filter((one) => of(one) !== '')) names.set(of(one), [...(names.get(of(one)) ?? []), one.robot]);
  return [...names].map(([said, who]) => [said, who.join(', ')]);
}

export interface StopSince {
  /** They have not confirmed it, and no row has shown them as stopped since. */
  open: RobotOrder[];
  /** How many of its robots have been released since. */
  released: number;
  /** Every robot is released: the stop keeps nobody. */
  isOver: boolean;
}

export class StopCourse {
  private readonly stopped = new Set<string>();
  private readonly released = new Set<string>();
  /** Since when rows have come without a gap, ms; nothing: they do not come. */
  private liveSince: number | null = null;

  constructor(private readonly robots: RobotOrder[]) {}

  /** `isLive`: the rows are those of now, and all of them. Rows that are not tell nothing. */
  see(rows: Row<RobotContent>[], now: number, isLive: boolean): void {
    this.liveSince = isLive ? (this.liveSince ?? now) : null;
    if (this.liveSince === null) return;
    const isShown = now - this.liveSince > SHOWN_MS;
    const byRobot = new Map(rows.map((row) => [row.node, row]));
    for (const order of this.robots) this.follow(order, byRobot.get(order.robot), isShown);
  }

  get since(): StopSince {
    const isOpen = ({ robot, state }: RobotOrder) => state !== 'confirmed' && !this.stopped.has(robot);
    return {
      open: this.robots.filter(isOpen), released: this.released.size,
      isOver: this.robots.length > 0 && this.released.size === this.robots.length,
    };
  }

  private follow({ robot, state }: RobotOrder, row: Row<RobotContent> | undefined, isShown: boolean): void {
    if (row?.content.fenced) {
      this.stopped.add(robot);
      this.released.delete(robot);
      return;
    }
    if (row !== undefined && row.live !== 'live') return;
    // One without a row has left the fleet. One that nobody has seen stand may have been released before a row showed it.
    if (this.stopped.has(robot) || (state === 'confirmed' && isShown)) this.released.add(robot);
  }
}
