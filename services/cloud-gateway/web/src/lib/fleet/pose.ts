/** Where a robot is in the hall, and how much charge it has, from what it sends in its own units. */
import type { Profile, RobotContent } from '../api/types';

/** Metres; x to the east, y to the north. */
export interface Pose {
  x: number;
  y: number;
}

const FARTHEST = 1e6;

function valueOf(robot: RobotContent, name: string): unknown {
  return robot.values.find((value) => value.name === name)?.value;
}

/** [x, y, ...], {"x", "y"}, or words "x y ..." as robots with fields send it. */
function numbersOf(value: unknown): number[] {
  const list = listOf(value);
  return list.every((one) => typeof one === 'number' && Number.isFinite(one)) ? (list as number[]) : [];
}

function listOf(value: unknown): unknown[] {
  if (Array.isArray(value)) return value;
  if (typeof value === 'string') return value.split(/[ ,]+/).filter((word) => word !== '').map(Number);
  if (typeof value !== 'object' || value === null) return [value];
  const { x, y } = value as Record<string, unknown>;
  return [x, y];
}

/** What neither drives nor flies stands at the origin of its frame. */
export function moves(profile: Profile): boolean {
  return profile.capabilities.some((word) => word === 'mobile' || word === 'fly');
}

function isInHall(pose: Pose): boolean {
  return Math.abs(pose.x) <= FARTHEST && Math.abs(pose.y) <= FARTHEST;
}

export function poseOf(robot: RobotContent, profile: Profile): Pose | null {
  const { length, x, y, yaw } = profile.frame;
  if (!(length > 0)) return null;
  if (!moves(profile)) return x === 0 && y === 0 && yaw === 0 ? null : { x, y };
  const [east, north] = numbersOf(valueOf(robot, 'position'));
  if (east === undefined || north === undefined) return null;
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  const pose = { x: x + (c * east - s * north) / length, y: y + (s * east + c * north) / length };
  return isInHall(pose) ? pose : null;
}

/** What 100 % is in a robot's `battery`; nothing: its unit is not known, or it does not measure charge. */
function fullBattery(profile: Profile): number | null {
  if (profile.mode === 'ros') return 1;
  if (profile.transport === 'udp-at') return 100;
  return profile.mode === 'interpreter' && (profile.transport === '' || profile.transport === 'lines') ? 100 : null;
}

function percent(value: unknown, full: number): number | null {
  const [is, ...more] = numbersOf(value);
  return is !== undefined && more.length === 0 && is >= 0 && is <= full ? (is / full) * 100 : null;
}

/** In percent. */
export function chargeOf(robot: RobotContent, profile: Profile | undefined): number | null {
  const told = percent(valueOf(robot, 'state_of_charge'), 100);
  if (told !== null || profile === undefined) return told;
  const full = fullBattery(profile);
  return full === null ? null : percent(valueOf(robot, 'battery'), full);
}

/** The unit of one of its values, where the fleet knows it; empty: it is the robot's own. */
export function unitOf(name: string, profile: Profile | undefined): string {
  if (name === 'state_of_charge') return '%';
  if (profile === undefined) return '';
  if (name === 'battery') return fullBattery(profile) === 100 ? '%' : '';
  if (name !== 'position' || !moves(profile)) return ''; // an arm's is of joints
  const unit = { 1: 'm', 1000: 'mm' }[profile.frame.length];
  return unit === undefined ? '' : `(x, y: ${unit})`; // what follows them may be an angle
}
