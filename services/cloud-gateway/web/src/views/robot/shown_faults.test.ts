import { expect, it } from 'vitest';
import type { RobotContent } from '../../lib/api/types';
import { shownFaults } from './shown_faults';

const out = (capability: string, text: string) => ({ capability, severity: 'CRITICAL', text, since: 1, retired: false, by: '' });
const fault = (capability: string, text: string) => ({ capability, severity: 'WARNING', text, since: 2 });
const said = (robot: unknown) => shownFaults(robot as RobotContent).map((one) => [one.capability, one.text]);

it('shows once what is told of the whole robot and of what it keeps out of use', () => {
  expect(said({ out_of_use: [out('mobile', 'a wheel is loose')], faults: [fault('mobile', 'a wheel is loose')] })).toEqual([['mobile', 'a wheel is loose']]);
  expect(said({ out_of_use: [out('', 'the motors are off')], faults: [fault('mobile', 'the motors are off')] })).toEqual([['', 'the motors are off']]);
  expect(said({ out_of_use: [out('', 'the motors are off'), out('mobile', 'the motors are off')], faults: [] })).toEqual([['', 'the motors are off']]);
  expect(said({ out_of_use: [out('', 'the motors are off')], faults: [fault('mobile', 'battery low')] })).toEqual([['', 'the motors are off'], ['mobile', 'battery low']]);
  const retired = { ...out('', 'a wheel is loose'), retired: true }; // as who has taken it out of service says
  expect(said({ out_of_use: [retired], faults: [fault('mobile', 'a wheel is loose')] })).toEqual([['', 'a wheel is loose'], ['mobile', 'a wheel is loose']]);
  expect(said({ out_of_use: [out('carry', 'stuck')], faults: [fault('mobile', 'stuck')] })).toEqual([['carry', 'stuck'], ['mobile', 'stuck']]);
});
