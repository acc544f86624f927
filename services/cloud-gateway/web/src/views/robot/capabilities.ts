/** What a robot can do, and what each capability lacks at the moment. */
import type { OutOfUse, Profile, RobotContent } from '../../lib/api/types';

export interface Capability {
  name: string;
  skills: string[];
  /** A fault of it or of the whole robot; a retirement; nothing: it can be used. */
  lacks: OutOfUse[];
}

export function capabilitiesOf(profile: Profile, robot: RobotContent): Capability[] {
  const plugged = profile.plugged.map((sensor) => sensor.kind);
  const names = [...new Set([...profile.capabilities, ...profile.skills.map((skill) => skill.capability), ...plugged])];
  return names.filter((name) => name !== '').sort().map((name) => ({
    name,
    skills: profile.skills.filter((skill) => skill.capability === name).map((skill) => skill.name),
    lacks: robot.out_of_use.filter((one) => one.capability === name || one.capability === ''),
  }));
}
