import { expect, it } from 'vitest';
import type { Schemas } from '../../lib/api/types';
import { answerOf } from './preflight';

const robot = (of: Partial<Schemas['PreflightRobot']>): Schemas['PreflightRobot'] => ({ robot: 'ur3', tasks: ['a'], ready: false, answers: false, why: [], ...of });

it('tells a robot that was not asked from one that did not answer', () => {
  expect(answerOf(robot({ asked: true, answers: true, answer_ms: 2.4 }))).toEqual({ said: 'answered', ms: 2.4 });
  expect(answerOf(robot({ asked: true }))).toEqual({ said: 'noAnswer', ms: 0 });
  expect(answerOf(robot({ asked: false }))).toEqual({ said: 'notAsked', ms: 0 });
  expect(answerOf(robot({}))).toEqual({ said: 'noAnswer', ms: 0 }); // an older gateway does not say whom it asked
});
