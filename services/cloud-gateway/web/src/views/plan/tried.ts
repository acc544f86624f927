/** Which scenario of the editor a simulation tries, by the simulation's id, while the page is open. */
export const tried = new Map<string, string>();

/** The parts of a simulation's address: its scenario's id stands in it, for the way back. */
export function placeOf(simulation: string): string[] {
  const scenario = tried.get(simulation);
  return scenario === undefined ? [simulation] : [simulation, scenario];
}
