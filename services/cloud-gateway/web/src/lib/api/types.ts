/** Names for what the gateway sends, from its OpenAPI document: `npm run types` makes schema.d.ts of it. */
import type { components, paths } from './schema';

export type Schemas = components['schemas'];
export type Paths = paths;

export type Live = Schemas['Live'];
export type RowKind = Schemas['RowKind'];
export type Severity = Schemas['Severity'];
export type Role = Schemas['UserRole'];
export type Session = Schemas['Session'];

/** A row of the live stream or of a list. */
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
/** A service of the gateway's node that rows come from. */
export type RowSource = NonNullable<Schemas['LiveFrame']['silent']>[number];
export type RemovedRow = Schemas['RemovedRow'];

export type NodeContent = Schemas['NodeContent'];
export type RobotContent = Schemas['RobotContent'];
export type RobotValue = Schemas['RobotValue'];
export type RobotFault = Schemas['RobotFault'];
export type Drivable = Schemas['Drivable'];
/** Who drives a robot by hand. */
export type Teleop = Schemas['TeleopContent'];
/** What becomes of this page's own drive. */
export type DriveAnswer = Schemas['LiveDrive']['drive'];
export type OutOfUse = Schemas['OutOfUse'];
export type Profile = Schemas['Profile'];
export type Frame = Schemas['RobotFrame'];
export type Skill = Schemas['Skill'];
export type Parameter = Schemas['SkillParameter'];
export type Sensor = Schemas['Sensor'];
export type RunSummary = Schemas['RunSummary'];
export type RunDetail = Schemas['RunView'];
export type TaskView = Schemas['TaskView'];
export type Alert = Schemas['Alert'];
export type Alarm = Schemas['Alarm'];
/** An alert, and what people have done with it as an alarm. */
export type AlertRow = Row<Alert> & { alarm: Alarm };

/** What became of an order to each robot. */
export type RobotOrder = Schemas['RobotOrder'];
