import { expect, it } from 'vitest';
import type { OutOfUse, Profile, RobotContent } from '../../lib/api/types';
import { capabilitiesOf } from './capabilities';

const fault = (capability: string): OutOfUse => ({ capability, severity: 'CRITICAL', text: 'stuck', since: 0, retired: false, by: '' });
const skill = (name: string, capability: string) => ({ name, capability, parameters: [], repeatable: false, timeout_s: 1 });

it('names what each capability can do and lacks, also those of plugged sensors', () => {
  const profile = {
    capabilities: ['mobile', 'carry'], skills: [skill('go_to', 'mobile'), skill('load', 'carry')],
    plugged: [{ kind: 'temperature' }],
  } as unknown as Profile;
  const robot = { out_of_use: [fault('mobile')] } as unknown as RobotContent;
  const found = capabilitiesOf(profile, robot).map((one) => [one.name, one.skills, one.lacks.length]);
  expect(found).toEqual([['carry', ['load'], 0], ['mobile', ['go_to'], 1], ['temperature', [], 0]]);
  const broken = capabilitiesOf(profile, { out_of_use: [fault('')] } as unknown as RobotContent);
  expect(broken.every((one) => one.lacks.length === 1)).toBe(true);
});
