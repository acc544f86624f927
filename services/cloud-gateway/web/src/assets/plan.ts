/** The floor plan, and where its edges lie in the hall's frame: metres, x to the east, y to the north. */
import type { Box } from '../lib/map/camera';
import url from './hall.svg?url';

export const plan: { url: string; box: Box } = { url, box: { west: -2, south: -2, east: 9, north: 6 } };
