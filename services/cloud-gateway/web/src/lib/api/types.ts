/** What the gateway sends: the rows of the live stream and of the lists. */
export type Live = 'live' | 'late' | 'not_heard' | 'refused';
export type RowKind = 'node' | 'robot' | 'profile' | 'run' | 'run_detail' | 'alert' | 'sensor' | 'reading' | 'teleop';
export type Severity = 'WARNING' | 'URGENT' | 'CRITICAL' | 'FATAL';
export type Role = 'viewer' | 'operator' | 'admin';

export interface Session {
  user: string;
  role: Role;
  csrf: string;
}

export interface Row<Content = unknown> {
  kind: RowKind;
  node: string;
  name: string;
  number: number;
  version: number;
  live: Live;
  heard: string;
  content: Content;
}

export interface RemovedRow {
  kind: RowKind;
  node: string;
  name: string;
  number: number;
  removed: true;
}

export interface NodeContent {
  role: string;
  state: string;
  address: string;
  version: string;
  clock: string;
  via: string;
  reason: string;
}

export interface OutOfUse {
  capability: string;
  severity: Severity;
  text: string;
  since: number;
  retired: boolean;
  by: string;
}

export interface RobotValue {
  name: string;
  value: unknown;
  changed: string;
}

export interface RobotFault {
  capability: string;
  severity: Severity;
  text: string;
  since: string;
}

export interface RobotContent {
  connection: string;
  detail: string;
  fenced: boolean;
  control: string;
  out_of_use: OutOfUse[];
  values: RobotValue[];
  faults: RobotFault[];
  cut: boolean;
}

export interface Parameter {
  name: string;
  type: string;
  required: boolean;
  unit: string;
  range: number[];
  one_of: string[];
  count: number;
}

export interface Skill {
  name: string;
  capability: string;
  parameters: Parameter[];
  repeatable: boolean;
  timeout_s: number;
}

export interface Sensor {
  name: string;
  kind: string;
  unit: string;
  identity: string;
  device: string;
  state: 'unread' | 'ok' | 'silent' | 'failed';
  detail: string;
}

export interface Frame {
  length: number;
  x: number;
  y: number;
  yaw: number;
}

export interface Profile {
  framework: string;
  mode: string;
  transport: string;
  maker: string;
  model: string;
  capabilities: string[];
  sensors: string[];
  skills: Skill[];
  places: string[];
  robot: string;
  detail: string;
  fenced: boolean;
  control: string;
  plugged: Sensor[];
  frame: Frame;
  out_of_use: OutOfUse[];
  numbers: { name: string; value: number; unit: string }[];
}

export interface RunSummary {
  run: string;
  name: string;
  state: string;
  waits_for: string;
  created: number;
  tasks: number;
  tasks_final: number;
  epoch: number;
  priority: number;
  left_s: number;
  over: number;
}

export interface TaskView {
  id: string;
  robot: string;
  skill: string;
  state: string;
  outcome: string;
  reason: string;
  attempt: number;
  started: number;
  ended: number;
  duration_s: number;
  after: number[];
  condition: string;
  moved_from: string;
  failed_by: string[];
  due: boolean;
  waits_for: string;
  data: string;
}

export interface RunDetail extends Omit<RunSummary, 'tasks' | 'tasks_final'> {
  submitter: string;
  expires: number;
  tasks: TaskView[];
  paused_by: string;
}

export interface Alert {
  id: string;
  run: string;
  name: string;
  robot: string;
  capability: string;
  severity: Severity;
  cause: string;
  text: string;
  tasks: string[];
  time: number;
  expires: number;
  state: 'OPEN' | 'RELEASING' | 'DECIDED' | 'EXPIRED' | 'CLOSED';
  needs_word: boolean;
  person: string;
  reason: string;
  waits_for: string;
}

/** What became of an order to each robot. */
export interface RobotOrder {
  robot: string;
  state: string;
  text: string;
}
