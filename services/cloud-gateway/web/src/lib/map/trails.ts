/** Where each robot was in its last positions, and the course that follows from the last two of them. */
import type { Point } from './camera';

const MOST = 60;
const LEAST_M = 0.02; // less is noise of its odometry

export class Trails {
  private readonly of = new Map<string, Point[]>();

  /** True: it has moved. */
  add(robot: string, at: Point): boolean {
    const trail = this.of.get(robot) ?? [];
    const last = trail.at(-1);
    if (last !== undefined && Math.hypot(at.x - last.x, at.y - last.y) < LEAST_M) return false;
    trail.push(at);
    if (trail.length > MOST) trail.shift();
    this.of.set(robot, trail);
    return true;
  }

  /** Robots that are not there any more leave no trail. */
  keep(robots: Set<string>): void {
    for (const robot of this.of.keys()) if (!robots.has(robot)) this.of.delete(robot);
  }

  trail(robot: string): Point[] {
    return this.of.get(robot) ?? [];
  }

  /** Radians counter-clockwise from east; nothing: it has not moved since the page was opened. */
  course(robot: string): number | null {
    const [from, to] = this.trail(robot).slice(-2);
    return from === undefined || to === undefined ? null : Math.atan2(to.y - from.y, to.x - from.x);
  }
}
