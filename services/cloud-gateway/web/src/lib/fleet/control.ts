/** Who commands a robot: a node, or a run, of which people see the beginning of its id. */
export interface Commander {
  text: string;
  /** Nothing: it is a node. */
  run: string | null;
}

const RUN = /^run ([0-9a-f]{32})$/;

export function commanderOf(control: string): Commander | null {
  if (control === '') return null;
  const run = RUN.exec(control)?.[1] ?? null;
  return { text: run === null ? control : `run ${run.slice(0, 8)}`, run };
}
