/** Every view of the page: a line each. All but the first one are loaded when they are opened. */
import type { Component } from 'svelte';
import type { Role } from '../lib/api/types';
import type { Key } from '../lib/i18n/en';
import Hall from './hall/Hall.svelte';

export interface View {
  /** The first part of its address: #/robots/ur3 is `robots`. */
  path: string;
  title: Key;
  /** Its component gets `parts`, the rest of the address; most need none. */
  load: () => Promise<{ default: Component<any> }>;
  /** In the navigation. */
  isListed?: boolean;
  /** In the menu of who is signed in: what is seldom needed. */
  isInMenu?: boolean;
  /** Who may open it; everybody, without it. */
  least?: Role;
}

export const views: View[] = [
  // Everybody begins here: in a file of its own it would be a dozen further requests, one after the other.
  { path: 'hall', title: 'hall.title', load: () => Promise.resolve({ default: Hall }), isListed: true },
  { path: 'robots', title: 'robot.title', load: () => import('./robot/Robot.svelte') },
  { path: 'control', title: 'control.title', load: () => import('./control/Control.svelte'), isListed: true },
  { path: 'scenarios', title: 'scenarios.title', load: () => import('./scenarios/Scenarios.svelte'), isListed: true },
  { path: 'plan', title: 'plan.title', load: () => import('./plan/Plan.svelte'), isListed: true },
  { path: 'runs', title: 'runs.title', load: () => import('./runs/Runs.svelte'), isListed: true },
  { path: 'alerts', title: 'alerts.title', load: () => import('./alerts/Alerts.svelte'), isListed: true },
  { path: 'sensors', title: 'sensors.title', load: () => import('./sensors/Sensors.svelte'), isListed: true },
  { path: 'messages', title: 'messages.title', load: () => import('./messages/Messages.svelte'), isListed: true },
  { path: 'audit', title: 'audit.title', load: () => import('./audit/Audit.svelte'), isInMenu: true, least: 'admin' },
  { path: 'users', title: 'users.title', load: () => import('./users/Users.svelte'), isInMenu: true, least: 'admin' },
  { path: 'settings', title: 'settings.title', load: () => import('./settings/Settings.svelte'), isInMenu: true, least: 'admin' },
  { path: 'access', title: 'access.title', load: () => import('./access/Access.svelte'), isInMenu: true, least: 'admin' },
  { path: 'about', title: 'about.title', load: () => import('./about/About.svelte'), isInMenu: true },
  { path: 'design', title: 'design.title', load: () => import('./design/Design.svelte') },
];

export const FIRST = 'hall';
