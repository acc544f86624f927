/** Certificates of nodes that end soon, or have ended lately: without a new one the fleet refuses the node. */
import type { NodeContent, Row } from '../api/types';

/** As a node's own router warns before its end. A certificate that ended longer ago is of a node that nobody misses. */
export const WINDOW_MS = 30 * 24 * 3600 * 1000;

export interface Ending {
  node: string;
  atMs: number;
}

/** The soonest end first. */
export function endingCertificates(rows: Row<NodeContent>[], nowMs: number): Ending[] {
  return rows
    .map((row) => ({ node: row.node, atMs: Date.parse(row.content.certificate_ends) }))
    .filter((one) => Math.abs(one.atMs - nowMs) <= WINDOW_MS)
    .sort((a, b) => a.atMs - b.atMs);
}

/** Whole days until the end, rounded down; negative: it has ended. */
export function daysUntil(atMs: number, nowMs: number): number {
  return Math.floor((atMs - nowMs) / (24 * 3600 * 1000));
}
