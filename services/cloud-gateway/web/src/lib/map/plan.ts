/** The hall's walls below the map: a picture, and where its edges lie in the hall's frame (metres, x to the east, y to the north). */
import demonstration from '../../assets/hall.svg?url';
import type { Schemas } from '../api/types';
import type { Box } from './camera';

export interface HallPlan {
  url: string;
  box: Box;
}

/** For the hall of the demonstration, which has no picture in its folder. */
export const DEMONSTRATION: HallPlan = { url: demonstration, box: { west: -2, south: -2, east: 9, north: 6 } };

/** Until the gateway has said which hall it is: no walls that are another hall's. */
export const UNKNOWN: HallPlan = { url: '', box: DEMONSTRATION.box };

export function planOf(places: Schemas['PlaceList']): HallPlan {
  return places.picture === undefined ? DEMONSTRATION : { url: '/api/v1/places/picture', box: places.picture };
}
