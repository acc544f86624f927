/** What a robot's line in the answer of a preflight says. */
import type { Schemas } from '../../lib/api/types';

export interface RobotAnswer {
  said: 'answered' | 'noAnswer' | 'notAsked';
  ms: number;
}

/** Who is not reached, or has no connection to its robot, is not asked: it cannot have failed to answer. */
export function answerOf(robot: Schemas['PreflightRobot']): RobotAnswer {
  if (robot.answers) return { said: 'answered', ms: robot.answer_ms ?? 0 };
  return { said: robot.asked === false ? 'notAsked' : 'noAnswer', ms: 0 };
}
